"""`fly` in other worlds than the paper's: motions and attitudes by name, and what it refuses."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import safestart as ss
from safestart.attitude.attitude import to_lvlh
from safestart.errors import InvalidInput
from safestart.simulation import plant
from tests.unit.simulation.parts import Nodding

POINT = ss.Scenario.of(3.0, 0.1)
START = (5.0, 40.0, 2.0)
NODDING = Nodding(0.2, 0.05)


class Coasting:
    """Never thrusts, and remembers where it began."""

    began: Any = None

    def begin(self, state: Any) -> None:
        self.began = np.array(state)

    def command(self, k: int, state: Any) -> list[float]:
        return [0.0, 0.0, 0.0]


@pytest.fixture(autouse=True)
def nodding(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(plant.ATTITUDES, "nodding", lambda _: NODDING)


def test_an_attitude_by_its_name_turns_the_corridor() -> None:
    flown = ss.fly(POINT, START, Coasting(), attitude="nodding", horizon_s=20.0)
    turn = NODDING.rotation(flown.time_s)
    assert np.allclose(flown.body_m, np.einsum("tij,tj->ti", turn, flown.lvlh_m), atol=1e-12)
    spun = ss.fly(POINT, START, Coasting(), horizon_s=20.0)
    assert np.array_equal(spun.lvlh_m[:3], flown.lvlh_m[:3]), "the chaser's path knows no attitude"
    assert not np.allclose(spun.body_m[1], flown.body_m[1])


@pytest.mark.parametrize("rest", ["lvlh", "body"])
def test_a_start_at_rest_in_the_turning_body(rest: str) -> None:
    pilot = Coasting()
    ss.fly(POINT, START, pilot, rest, attitude="nodding", horizon_s=4.0)
    still = np.array([[*START, 0.0, 0.0, 0.0]])
    moving = to_lvlh(NODDING, np.zeros(1), still)[0]
    assert np.array_equal(pilot.began[:3], moving[:3])
    assert np.array_equal(pilot.began[3:], moving[3:] if rest == "body" else np.zeros(3))


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"controller": "filter", "attitude": "nodding"}, "attitude: required spin"),
        ({"controller": ss.controller("filter", POINT), "attitude": "nodding"}, "attitude: required spin"),
        ({"controller": Coasting(), "attitude": "nodding", "start": (5.0, 40.0)}, r"shape \(3,\)"),
        (
            {"controller": Coasting(), "attitude": "asleep"},
            "attitude: required one of spin, nodding, received",
        ),
        ({"attitude": "nodding"}, "without a controller"),
        ({"motion": "two_body_j2"}, "motion: required cwh, without a controller"),
        ({"controller": "filter", "motion": ["cwh"]}, "motion: required one of cwh, two_body_j2, received"),
        ({"rest": "inertial"}, "rest: required lvlh or body, received 'inertial'"),
        ({"controller": 5}, "controller: required filter, sequence or an object with command"),
        ({"controller": "filter", "dt_s": "two"}, "dt_s: required a finite number"),
        ({"controller": "filter", "dt_s": math.nan}, "dt_s: required a finite number"),
        ({"controller": "filter", "horizon_s": "a minute"}, "horizon_s: required a finite number"),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_sentence(options: dict[str, Any], said: str) -> None:
    with pytest.raises(InvalidInput, match=said):
        ss.fly(POINT, options.pop("start", START), **options)


def test_a_two_body_motion_needs_an_orbit() -> None:
    still = ss.Scenario.of(3.0, 0.1, mean_motion=0.0)
    with pytest.raises(
        InvalidInput, match=r"mean_motion: required 1e-06 to .* rad/s for two_body_j2, received 0"
    ):
        ss.fly(still, START, Coasting(), motion="two_body_j2")


def test_a_controllers_times_are_numbers() -> None:
    with pytest.raises(InvalidInput, match="duration_s: required a finite number"):
        ss.controller("filter", POINT, duration_s="long")  # type: ignore[arg-type]


def test_inputs_of_a_run_are_a_mapping() -> None:
    with pytest.raises(
        InvalidInput, match="inputs: required an object of names and values, received \\[1\\]"
    ):
        ss.run("flight", [1])  # type: ignore[arg-type]

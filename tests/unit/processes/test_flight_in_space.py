"""flight-in-space: what is flown is what the exact answer says, by either way; refusals; the picture's curves."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from benchmarks.peers.space_flight import flown_margin
from safestart.errors import InvalidInput
from safestart.processes.execute import execute
from safestart.processes.registry import process
from safestart.processes.start_in_space.question import stay_in
from safestart.runtime.progress import Context

SPEC = process("flight-in-space")
TOO_FAST = {"start": {"position_m": [2, 25, 1], "velocity_m_s": [0, -3, 0], "frame": "body"}}


def flown(**changes: Any) -> dict[str, Any]:
    outputs: dict[str, Any] = execute(SPEC.id, copy.deepcopy(SPEC.example) | changes, Context()).document[
        "outputs"
    ]
    return outputs


@pytest.mark.parametrize("by", ["exact", "sequence"])
@pytest.mark.parametrize(
    "more",
    [
        {},
        {"orbit": {"semi_major_axis_m": 24396000, "eccentricity": 0.7283, "true_anomaly_deg": 20}},
        {"thrust": {"kind": "box", "a_max_m_s2": [0.08, 0.08, 0.05], "frame": "body"}},
    ],
)
def test_a_go_stays_as_an_integrator_sees_it(by: str, more: dict[str, Any]) -> None:
    found = flown(flown_by=by, **more)
    assert (found["verdict"], found["stayed"], found["left_at_s"]) == ("GO", "stayed", None)
    assert found["closest_m"] >= found["margin_m"] - 1e-3
    # Four instants an interval, the last entry a copy: one thrust for each interval.
    thrust = np.array(found["thrust_m_s2"])[:-1:4]
    question = stay_in(SPEC.parse(copy.deepcopy(SPEC.example) | more), 60.0)
    state = np.concatenate([found["lvlh_m"][0], found["lvlh_m_s"][0]])
    assert flown_margin(question, state, thrust) == pytest.approx(found["closest_m"], abs=2e-3)
    assert np.array(found["distance_m"]).min() >= found["closest_m"] - 1e-9
    assert len(found["faces"]) == len(found["distance_m"][0]) == 5


def test_a_no_go_leaves_and_says_where_and_when() -> None:
    exact, loop = flown(**TOO_FAST), flown(**TOO_FAST, flown_by="sequence")
    for found in (exact, loop):
        assert (found["verdict"], found["stayed"]) == ("NO_GO", "left")
        assert found["closest_m"] < 0.0
        assert 0.0 < found["left_at_s"] <= found["time_s"][-1]
    assert exact["time_s"][-1] == 60.0
    assert exact["closest_m"] == pytest.approx(exact["margin_m"], abs=1e-2)
    # The loop ends where it left.
    assert loop["time_s"][-1] - loop["left_at_s"] <= 2.0


def test_noise_of_navigation_counts_and_is_the_seed_s() -> None:
    noisy = {"flown_by": "sequence", "position_sigma_m": 0.3, "velocity_sigma_m_s": 0.01, "horizon_s": 20}
    one, other = flown(**noisy), flown(**noisy, seed=1)
    assert one == flown(**noisy)
    assert (
        one["thrust_m_s2"] != other["thrust_m_s2"] != flown(flown_by="sequence", horizon_s=20)["thrust_m_s2"]
    )


def test_a_start_outside_is_flown_by_no_controller() -> None:
    outside = {"start": {"position_m": [2, -25, 1]}}
    found = flown(**outside)
    assert (found["verdict"], found["closest_face"], found["left_at_s"]) == ("NO_GO", "hold_plane", 0.0)
    with pytest.raises(InvalidInput, match="outside hold_plane"):
        flown(**outside, flown_by="sequence")


def test_refusals() -> None:
    with pytest.raises(InvalidInput, match="position_sigma_m"):
        flown(position_sigma_m=0.1)
    with pytest.raises(InvalidInput, match=r"attitude\.inertia_kg_m2"):
        flown(attitude=SPEC.example["attitude"] | {"inertia_kg_m2": [[1, 0, 0], [0, 1, 0], [0, 0, 5]]})
    for wrong in ({"starts": []}, {"start": {"position_m": [0, 30, 0]}}, {"orbit": {"mean_motion_rad_s": 0}}):
        with pytest.raises(InvalidInput, match="flight-in-space"):
            process("flight").parse(
                {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "start": {"x_m": 5, "y_m": 40}} | wrong
            )

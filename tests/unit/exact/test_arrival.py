"""After the end of `synchronize`: stops from the edge of what is certified are flown, and what is wrong is refused."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from benchmarks.peers.manoeuvre_flight import fly
from safestart.closed_form.manoeuvre import Manoeuvre
from safestart.exact.answer import Arrival
from safestart.exact.arrival import arrival_of
from safestart.exact.decide import decide
from safestart.exact.prove import proof_of
from safestart.exact.question import Goal, Question
from safestart.model.scenario import Chaser, CorridorShape, Floats, Rest, Scenario, Target
from safestart.proofs.checker import check
from safestart.proofs.statement import digest_of
from safestart.proofs.strict import ProofRejected

SHAPE = CorridorShape(1.2, 0.7, 3.0, 2.0, 0.75)


def question(rate: float, a_max: float, n: float, d: int, speed: float | None = None) -> Question:
    return Question(Scenario(Target(rate, n), Chaser(a_max), SHAPE), 2.0, 60, d, Goal(), speed)


def at(place: Floats, velocity: Floats, rate: float, d: int) -> Floats:
    """LVLH state (2 d,) at t = 0 of body-frame place and velocity (3,)."""
    return np.r_[place[:d], (velocity + rate * np.array([-place[1], place[0], 0.0]))[:d]]


@pytest.mark.parametrize("seed", range(12))
def test_stops_at_the_edge_of_the_certificate_fly(seed: int) -> None:
    """The largest velocity that is certified, in a random direction: thrust, distance and rest by DOP853."""
    rng = np.random.default_rng(seed)
    rate, n, d = (
        float(rng.choice([0.0, 0.02, 0.09])),
        float(rng.choice([0.0, 1.1e-3])),
        int(rng.integers(2, 4)),
    )
    unit = min(30.0, 0.05 / max((rate + n) ** 2, 1e-9))
    asked = question(rate, 0.05, n, d)
    place = np.array([0.3, 0.75 + 0.5 * unit * rng.random(), 0.4 if d == 3 else 0.0])
    way = rng.normal(size=3) * [1.0, 1.0, float(d == 3)]
    way /= np.linalg.norm(way)
    low, high = 0.0, 10.0
    for _ in range(50):
        middle = 0.5 * (low + high)
        found = arrival_of(asked, at(place, middle * way, rate, d), 0.0)
        low, high = (low, middle) if found is None else (middle, high)
    found = arrival_of(asked, at(place, low * way, rate, d), 0.0)
    assert found is not None
    assert low > 1e-3
    moved = 0.5 * found.stop * low * way
    plan = Manoeuvre(place, np.array([np.zeros(3), moved, moved]), found.stop, rate, n)
    start = low * way + rate * np.array([-place[1], place[0], 0.0])
    flown = fly(asked.scenario, Rest.BODY, place[:d], plan, 2.0 * math.pi / max(rate, 0.01), velocity=start)
    assert flown.thrust <= 1.0
    assert flown.least >= found.margin - 1e-6
    assert flown.off < 1e-5
    assert flown.drift < 1e-6


def test_the_phase_counts_for_nothing() -> None:
    asked = question(0.05, 0.05, 1.1e-3, 2)
    state, time = at(np.array([0.5, 3.0, 0.0]), np.array([0.1, -0.2, 0.0]), 0.05, 2), 37.0
    c, s = math.cos(0.05 * time), math.sin(0.05 * time)
    turn = np.array([[c, -s], [s, c]])
    later = arrival_of(asked, np.r_[turn @ state[:2], turn @ state[2:]], time)
    now = arrival_of(asked, state, 0.0)
    assert now is not None
    assert later is not None
    assert (later.stop, later.margin) == pytest.approx((now.stop, now.margin), rel=1e-9)


@pytest.mark.parametrize(
    ("place", "velocity", "a_max", "speed"),
    [
        ((0.0, 0.76, 0.0), (0.0, -0.2, 0.0), 0.05, None),  # no room in front of the hold plane
        ((0.0, 20.1, 0.0), (0.0, 0.0, 0.0), 0.05, None),  # standing there takes 0.0503 m/s^2 at 0.05 rad/s
        ((0.0, 5.0, 0.0), (0.0, 3.0, 0.0), 0.05, None),  # too fast for the thrust
        ((0.0, 5.0, 0.0), (0.0, 0.01, 0.0), 0.05, 0.2),  # turning with the body is faster than the limit
    ],
)
def test_what_cannot_stop_is_not_certified(
    place: tuple[float, ...], velocity: tuple[float, ...], a_max: float, speed: float | None
) -> None:
    asked = question(0.05, a_max, 0.0, 2, speed)
    assert arrival_of(asked, at(np.array(place), np.array(velocity), 0.05, 2), 0.0) is None


@pytest.fixture(scope="module")
def proved() -> dict[str, Any]:
    """One step, too short to come to rest: a few cm/s are left at the end."""
    asked = replace(question(0.05, 0.02, 1.1e-3, 2), steps=1, goal=Goal(0.5, 0.05, (0.0, 1.5)))
    state = at(np.array([0.1, 1.5, 0.0]), np.array([0.0, 0.06, 0.0]), 0.05, 2)
    answer = decide(asked, state)
    assert isinstance(answer.arrival, Arrival)
    assert answer.arrival.stop > 0.5
    return proof_of(asked, state, answer)


def test_the_checker_proves_it_and_says_so(proved: dict[str, Any]) -> None:
    (line,) = [line for line in check(proved).statement if line.startswith("after that end for ever")]
    assert repr(proved["arrival"]["stop_s"]) in line
    assert repr(proved["arrival"]["margin_m"]) in line
    bare = {key: value for key, value in proved.items() if key != "arrival"}
    bare["digest"] = digest_of(bare)
    assert not any("for ever" in line for line in check(bare).statement)


@pytest.mark.parametrize(
    ("arrival", "said"),
    [
        ({"stop_s": 0.1}, "the stop may take"),  # no time to brake
        ({"stop_s": 1e4}, "the stop may take"),  # drifts away
        ({"margin_m": 1.0}, "margin_m"),
        ({"margin_m": 0.0}, "margin_m"),
        ({"margin_m": -1.0}, "margin_m"),
        ({"stop_s": 0.0}, "stop_s"),
        ({"stop_s": True}, "stop_s"),
        ({"note": 1.0}, "note"),
    ],
)
def test_forged_arrivals_are_rejected(proved: dict[str, Any], arrival: dict[str, Any], said: str) -> None:
    forged = proved | {"arrival": proved["arrival"] | arrival}
    forged["digest"] = digest_of(forged)
    with pytest.raises(ProofRejected, match=said):
        check(forged)


@pytest.mark.parametrize("key", ["stay", "no-go"])
def test_only_a_go_of_synchronize_may_have_it(proved: dict[str, Any], key: str) -> None:
    if key == "stay":
        asked = question(0.05, 0.3, 1.1e-3, 2)
        other = proof_of(
            replace(asked, goal=None, steps=8),
            np.array([0.3, 2.0, 0.0, -0.1]),
            decide(replace(asked, goal=None, steps=8), np.array([0.3, 2.0, 0.0, -0.1])),
        )
    else:
        asked = replace(question(0.05, 0.01, 1.1e-3, 2), steps=4)
        state = np.array([0.3, 20.0, 0.0, -0.1])
        other = proof_of(asked, state, decide(asked, state))
        assert other["verdict"] == "NO_GO"
    forged = other | {"arrival": proved["arrival"]}
    forged["digest"] = digest_of(forged)
    with pytest.raises(ProofRejected, match="arrival"):
        check(forged)

"""The least drift away: what it proves, that less does not, and where the drift goes."""

import math

import numpy as np
import pytest

from safestart.dynamics.cwh import transition_matrix
from safestart.hopping.approach import Approach, approach, mean_motion_of, with_phases
from safestart.hopping_safety.away import drift_per_orbit, least_away
from safestart.missed_burn.plan import Errors, Plan, Question
from safestart.missed_burn.prove import greatest_scale

N = mean_motion_of(8.1e6)
HORIZON = 2.0 * math.tau / N
SIGMA = Errors((0.5, 0.5, 0.5), (1e-3, 1e-3, 1e-3), 0.01, math.radians(0.5))


def level(plan: Approach) -> float:
    flight = Plan.of(N, plan.states()[0].tolist(), plan.times[:-1].tolist(), plan.impulses[:-1])
    return greatest_scale(Question(flight, 50.0, HORIZON, SIGMA))


def test_the_drift_of_an_orbit() -> None:
    state = np.array([30.0, 200.0, 0.0, 0.02, -0.05, 0.0])
    after = transition_matrix(N, math.tau / N) @ state
    assert after[1] - state[1] == pytest.approx(drift_per_orbit(N, state), rel=1e-9)


@pytest.mark.parametrize(("angle", "demand"), [(0.0, 1.0), (0.0, 1.5), (20.0, 4.0), (180.0, 1.0)])
def test_it_is_proved_and_less_is_not(angle: float, demand: float) -> None:
    plan = approach(N, angle, 2000.0, 100.0, 5)
    found = least_away(plan, 50.0, HORIZON, SIGMA.scaled(demand))
    assert found is not None
    assert level(plan) < demand * 0.99
    assert level(found.approach) >= demand * 0.998
    changed = np.array(
        [new.phase / old.phase - 1.0 for new, old in zip(found.approach.hops, plan.hops, strict=True)]
    )
    assert abs(changed[-1]) > 1e-3
    phases = np.array([hop.phase for hop in plan.hops]) * (1.0 + 0.9 * changed)
    d = np.array([2000.0, *(hop.end for hop in plan.hops)])
    assert level(with_phases(N, angle, d, phases)) < demand


def test_the_v_bar_drifts_away_on_its_last_hop() -> None:
    """34 m per orbit in the findings, of a drift that was not closed in on; ahead of the target it goes ahead."""
    plan = approach(N, 0.0, 2000.0, 100.0, 5)
    found = least_away(plan, 50.0, HORIZON, SIGMA)
    assert found is not None
    assert found.added[:-1].tolist() == [0.0] * 4
    assert found.added[-1] == pytest.approx(32.3, abs=0.3)
    assert drift_per_orbit(N, found.approach.hops[-1].left_with) == pytest.approx(found.added[-1], rel=1e-6)
    assert found.approach.hops[-1].arrives_with[:3] == pytest.approx([0.0, 100.0, 0.0], abs=1e-6)


def test_what_is_proved_as_planned_stays() -> None:
    plan = approach(N, 90.0, 2000.0, 100.0, 5)
    found = least_away(plan, 50.0, HORIZON, SIGMA)
    assert found is not None
    assert not found.added.any()
    assert found.approach.impulses == pytest.approx(plan.impulses, abs=1e-12)


def test_none_where_no_drift_helps() -> None:
    plan = approach(N, 0.0, 2000.0, 51.0, 5)
    assert least_away(plan, 50.0, HORIZON, SIGMA.scaled(30.0)) is None

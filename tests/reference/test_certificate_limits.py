"""Where the paper's closed form is wrong: a certified start that no thrust history keeps in the corridor.

Paper 000 calls (8) and (9) a sound inner certificate. Close to r_sync they are not: the linear program below is a
relaxation (the thrust disk is replaced by a polygon around it, the corridor is asked for at samples only), and even so
its best history leaves the corridor by more than a metre. The value has converged in dt.
"""

import math

import numpy as np
import pytest
from scipy.optimize import linprog

from safestart.attitude.body_frame import rotation
from safestart.closed_form.paper import certify
from safestart.constraints.corridor import corridor_of
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.model.scenario import Floats, Scenario

SCENARIO = Scenario.of(2.0, 0.05)
START = np.array([9.364, 81.044])
SIDES = 32


def best_margin(scenario: Scenario, start: Floats, horizon: float, dt: float) -> float:
    """Largest face distance (m) that can be held at every node up to the horizon, thrust in the outer polygon."""
    n, w, a_max = scenario.target.mean_motion, scenario.target.tumble_rate, scenario.chaser.max_acceleration
    corridor = corridor_of(scenario.corridor)
    count = round(horizon / dt)
    rows, bounds = [], []
    for k in range(1, count + 1):
        turn = rotation(-w * k * dt)
        drift = turn @ (planar_transition(n, k * dt)[:, :2] @ start)[:2]
        gain = np.zeros((2, 2 * count))
        for j in range(k):
            gain[:, 2 * j : 2 * j + 2] = (planar_transition(n, (k - 1 - j) * dt) @ planar_input(n, dt))[:2]
        rows.append(np.column_stack([corridor.normals @ turn @ gain, corridor.lengths]))
        bounds.append(corridor.offsets - corridor.normals @ drift)
    angles = 2.0 * math.pi * np.arange(SIDES) / SIDES
    sides = np.column_stack([np.cos(angles), np.sin(angles)])
    disk = np.kron(np.eye(count), sides)
    rows.append(np.column_stack([disk, np.zeros(len(disk))]))
    bounds.append(np.full(len(disk), a_max))
    cost = np.append(np.zeros(2 * count), -1.0)
    found = linprog(
        cost, A_ub=np.vstack(rows), b_ub=np.concatenate(bounds), bounds=(None, None), method="highs"
    )
    assert found.success
    return float(found.x[-1])


def test_a_certified_start_that_cannot_stay() -> None:
    answer = certify(SCENARIO, START)
    assert bool(answer.safe)
    assert float(answer.margin) == pytest.approx(0.487, abs=1e-3)
    coarse, fine = (best_margin(SCENARIO, START, 60.0, dt) for dt in (2.0, 1.0))
    assert coarse == pytest.approx(-1.148, abs=2e-3)
    assert fine == pytest.approx(coarse, abs=1e-3)


def test_well_inside_the_certificate_holds() -> None:
    """The same program finds thrust for certified starts away from the sliver, so that it can say yes, too."""
    for start in (np.array([0.0, 60.0]), np.array([-30.0, 40.0]), np.array([5.0, 30.0])):
        assert bool(certify(SCENARIO, start).safe)
        assert best_margin(SCENARIO, start, 60.0, 2.0) > 0.0

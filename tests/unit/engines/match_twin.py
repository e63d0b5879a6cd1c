"""Twin of the velocity-aware target: one cone program per start and time, thrust held over 2 s intervals.

At t_k the start counts when some thrust history has the position in the turned corridor and the velocity within
``match`` of co-rotation; the set is the union over k. Held thrust can do less than the level set's, a little.
"""

import math

import clarabel
import numpy as np
from scipy.sparse import csc_array

from safestart.constraints.corridor import corridor_of
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.model.scenario import Bools, Floats, Scenario


def reaches(scenario: Scenario, points: Floats, horizon: float, match: float, dt: float = 2.0) -> Bools:
    """Whether starts (P, 2) at rest in LVLH reach the velocity-aware target at a node up to the horizon."""
    n, w = scenario.target.mean_motion, scenario.target.tumble_rate
    a = scenario.chaser.max_acceleration
    step, push = planar_transition(n, dt), planar_input(n, dt)
    corridor = corridor_of(scenario.corridor)
    unit, offset = corridor.normals / corridor.lengths[:, None], corridor.offsets / corridor.lengths
    against = np.array([[0.0, w, 1.0, 0.0], [-w, 0.0, 0.0, 1.0]])
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_threads = False, 1
    found = np.zeros(len(points), dtype=bool)
    driven = np.zeros((4, 0))
    for k in range(round(horizon / dt) + 1):
        angle = w * k * dt
        turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
        rows = np.hstack([unit @ turn, np.zeros((3, 2))])
        free = np.linalg.matrix_power(step, k)
        count = 2 * k + 1
        disks = np.zeros((3 * k, count))
        for j in range(k):
            disks[3 * j + 1, 2 * j] = disks[3 * j + 2, 2 * j + 1] = -1.0
        left = np.vstack(
            [
                np.hstack([a * rows @ driven, np.ones((3, 1))]),
                np.append(np.zeros(2 * k), 1.0)[None],
                np.hstack([-a * against @ driven, np.zeros((2, 1))]),
                disks,
            ]
        )
        cones = [clarabel.NonnegativeConeT(3), *[clarabel.SecondOrderConeT(3)] * (k + 1)]
        cost = np.append(np.zeros(2 * k), -1.0)
        for i in np.nonzero(~found)[0]:
            at = free @ np.append(points[i], [0.0, 0.0])
            right = np.concatenate([offset - rows @ at, [match], against @ at, np.tile([1.0, 0.0, 0.0], k)])
            solved = clarabel.DefaultSolver(
                csc_array((count, count)), cost, csc_array(left), right, cones, settings
            ).solve()
            assert str(solved.status) in ("Solved", "AlmostSolved")
            found[i] = solved.x[-1] >= 0.0
        driven = np.hstack([step @ driven, push])
    return found

"""The exact questions with T fixed as one dense linear program: polygons for disks, samples for all times (HiGHS).

``outer`` polygons lie around the disks: the margin is then no smaller than the exact one. Inner polygons lie inside:
the margin is no larger, but for what the samples miss. Rows come from CWH matrices, one time after the other.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import linprog

from safestart.attitude.body_frame import rotation
from safestart.constraints.corridor import corridor_of
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.exact.question import Question
from safestart.model.scenario import Floats

SIDES, CHECKS = 32, 4


def margin(question: Question, state: Floats, *, outer: bool) -> float:
    """Largest margin (m) of a planar start (4,) with the polygons around or inside the disks."""
    scenario, dt, steps = question.scenario, question.dt, question.steps
    n, w, a_max = scenario.target.mean_motion, scenario.target.tumble_rate, scenario.chaser.max_acceleration
    corridor = corridor_of(scenario.corridor)
    angles = 2.0 * math.pi * np.arange(SIDES) / SIDES
    around = np.column_stack([np.cos(angles), np.sin(angles)])
    # |p| <= R follows from around . p <= R cos(pi / SIDES), and implies around . p <= R.
    shrink = 1.0 if outer else math.cos(math.pi / SIDES)
    left, right = [], []

    def norm(limit: float, constant: Floats, drive: Floats) -> None:
        """limit - |constant + drive u| >= m: inside, with |p| at most around . p / shrink at best."""
        for side in around:
            left.append(np.append(side @ drive / shrink, 1.0))
            right.append(limit - float(side @ constant) / shrink)

    drive, reach = np.zeros((4, 2 * steps)), state
    for k in range(steps):
        for part in range(1, CHECKS + 1):
            tau = dt * part / CHECKS
            phi, gain = planar_transition(n, tau), planar_input(n, tau)
            now, at = phi @ drive, phi @ reach
            now[:, 2 * k : 2 * k + 2] += gain
            turned = corridor.normals / corridor.lengths[:, None] @ rotation(-w * (k * dt + tau))
            for row, offset in zip(turned, corridor.offsets / corridor.lengths, strict=True):
                left.append(np.append(row @ now[:2], 1.0))
                right.append(offset - float(row @ at[:2]))
            if question.speed_limit is not None:
                norm(10.0 * question.speed_limit, 10.0 * at[2:], 10.0 * now[2:])
        drive, reach = now, at
    if question.goal is not None:
        goal, turn = question.goal, rotation(-w * steps * dt)
        spin = w * np.array([[0.0, -1.0], [1.0, 0.0]])
        norm(goal.radius, turn @ reach[:2] - np.array(question.hold), turn @ drive[:2])
        scale = goal.radius / goal.rest
        norm(goal.radius, scale * (reach[2:] - spin @ reach[:2]), scale * (drive[2:] - spin @ drive[:2]))
    for k in range(steps):
        for side in around:
            row = np.zeros(2 * steps + 1)
            row[2 * k : 2 * k + 2] = side
            left.append(row)
            right.append(a_max * shrink)
    cost = np.zeros(2 * steps + 1)
    cost[-1] = -1.0
    done = linprog(cost, np.array(left), np.array(right), bounds=(None, None), method="highs")
    assert done.status == 0, done.message
    return float(-done.fun)

"""Twin of the exact question's linear model, written straight from the matrices: slow, plain, and shared by tests."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.attitude.body_frame import rotation
from safestart.constraints.corridor import corridor_of
from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.exact.question import Question
from safestart.model.scenario import Floats


@dataclass(frozen=True, slots=True)
class Rows:
    """Face distances (m) at some times: ``offset`` (F,), ``start`` (J, F, 2 d), ``thrust`` (J, F, N d).

    J times, F faces, d dimensions, N intervals; the state is (position, velocity) in LVLH, thrust in LVLH axes.
    """

    times: Floats
    offset: Floats
    start: Floats
    thrust: Floats

    def constant(self, state: Floats) -> Floats:
        """The part without thrust, (J, F), for one start (2 d,)."""
        out: Floats = self.offset + self.start @ state
        return out


def rows(question: Question, times: Floats) -> Rows:
    """The affine model at the given times (J,), each in [0, T] seconds."""
    d, count, dt = question.dimensions, question.steps, question.dt
    times = np.atleast_1d(np.asarray(times, dtype=np.float64))
    target = question.scenario.target
    corridor = corridor_of(question.scenario.corridor, d)
    keep = np.r_[0:d, 3 : 3 + d]
    held = input_matrix(target.mean_motion, dt)[:, :d]
    start = np.empty((len(times), len(corridor.offsets), 2 * d))
    thrust = np.zeros((len(times), len(corridor.offsets), count * d))
    for j, t in enumerate(times):
        turn = np.eye(d)
        turn[:2, :2] = rotation(-target.tumble_rate * t)
        normals = -(corridor.normals @ turn) / corridor.lengths[:, None]
        start[j] = normals @ transition_matrix(target.mean_motion, t)[:d][:, keep]
        last = min(math.floor(float(t) / dt * (1 + 1e-14)), count)
        for k in range(last):
            reach = transition_matrix(target.mean_motion, t - (k + 1) * dt)[:d] @ held
            thrust[j, :, k * d : (k + 1) * d] = normals @ reach
        rest = t - last * dt
        if last < count and rest > 0.0:
            now = input_matrix(target.mean_motion, rest)[:d, :d]
            thrust[j, :, last * d : (last + 1) * d] = normals @ now
    return Rows(times, corridor.offsets / corridor.lengths, start, thrust)

"""The exact question and its linear model: face distances as affine functions of the start and the thrust history.

Question `stay`: does any thrust history, held over intervals of dt and of norm at most a_max, keep the chaser in the
rotating corridor at ALL times of [0, T]? The corridor is polyhedral at every instant and CWH is linear, so for a
start x0 and thrusts u the distance to face i at time t, slack / |A_i| in metres, is

    f_i(t) = offset_i + start_i(t) . x0 + sum_k thrust_ik(t) . u_k.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.corridor import corridor_of
from safestart.dynamics.body_frame import rotation
from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.errors import invalid
from safestart.scenario import Floats, Scenario, number

MAX_STEPS = 400
MAX_TIME = 3600.0


@dataclass(frozen=True, slots=True)
class Question:
    """Horizon of ``steps`` intervals of ``dt`` seconds; ``dimensions`` 2 (in the orbit plane) or 3."""

    scenario: Scenario
    dt: float = 2.0
    steps: int = 30
    dimensions: int = 2

    def __post_init__(self) -> None:
        number("dt", self.dt, 0.0, MAX_TIME, open_low=True)
        if (
            isinstance(self.steps, bool)
            or not isinstance(self.steps, int)
            or not 1 <= self.steps <= MAX_STEPS
        ):
            raise invalid("steps", f"an integer in [1, {MAX_STEPS}]", self.steps)
        number("horizon", self.steps * self.dt, 0.0, MAX_TIME, open_low=True)
        if self.dimensions not in (2, 3):
            raise invalid("dimensions", "2 or 3", self.dimensions)

    @property
    def horizon(self) -> float:
        """T in seconds."""
        return self.steps * self.dt


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
    if not (
        np.isfinite(times).all() and (times >= 0.0).all() and (times <= question.horizon * (1 + 1e-12)).all()
    ):
        raise invalid("times", f"times in [0, {question.horizon:g}] s", times)
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

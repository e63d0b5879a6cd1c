"""Limits on norms, in metres: the hold ball and the rest at the end, the speed at all times.

Each reads limit - |M x(t) - centre| >= m for the state x(t) in LVLH. With w the tumble rate and R(-w t) the turn into
the body frame,

    hold:  M = [R(-w T), 0], centre the hold point, limit its radius;
    rest:  M = s [R(-w T)] [-W, I] with W r = w x r, limit the same radius, s = radius / (largest speed at the end);
    speed: M = S [0, I], limit S v_max, S = ``SPEED_SCALE`` seconds.

For every vector p with |p| <= weight, weight (limit - |y|) <= weight limit - p . y; proofs use this bound.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.attitude.body_frame import rotation
from safestart.exact.question import SPEED_SCALE, Question
from safestart.model.scenario import Floats

AT_END = ("hold", "rest")
SPEED = "speed"


@dataclass(frozen=True, slots=True)
class Limit:
    """limit - |matrix @ x - centre| in metres; ``matrix`` (d, 2 d), ``centre`` (d,)."""

    matrix: Floats
    centre: Floats
    limit: float

    def left(self, state: Floats) -> float:
        """Metres left at a state (2 d,)."""
        y = self.matrix @ state - self.centre
        return self.limit - math.sqrt(float(y @ y))


def speed_limit(most: float, d: int) -> Limit:
    """The limit ``speed``, ``most`` m/s, in ``d`` dimensions."""
    matrix = np.zeros((d, 2 * d))
    matrix[:, d:] = SPEED_SCALE * np.eye(d)
    return Limit(matrix, np.zeros(d), SPEED_SCALE * most)


def limit_at(question: Question, name: str, time: float) -> Limit:
    """The limit ``hold``, ``rest`` or ``speed`` of a question at a time in seconds."""
    d, rate, goal = question.dimensions, question.scenario.target.tumble_rate, question.goal
    matrix, centre = np.zeros((d, 2 * d)), np.zeros(d)
    if name == SPEED or goal is None:
        return speed_limit(float(question.speed_limit or 0.0), d)
    turn = np.eye(d)
    turn[:2, :2] = rotation(rate * time).T
    if name == "hold":
        matrix[:, :d] = turn
        return Limit(matrix, np.array(question.hold, dtype=np.float64), goal.radius)
    matrix[:, d:] = goal.scale * turn
    # w x r = w (-y, x): the velocity of the body frame at r.
    matrix[:, 0], matrix[:, 1] = -goal.scale * rate * turn[:, 1], goal.scale * rate * turn[:, 0]
    return Limit(matrix, centre, goal.radius)

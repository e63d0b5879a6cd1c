"""A question with a hold after its end, its document, and the loop of the hold by matrix exponentials."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
from scipy.linalg import expm

from safestart.exact.answer import Held
from safestart.exact.decide import decide
from safestart.exact.hold_after import with_hold
from safestart.exact.prove import proof_of
from safestart.exact.question import Goal, Question
from safestart.model.scenario import Chaser, CorridorShape, Floats, Scenario, Target
from tests.unit.proofs.forgery import Document

SHAPE = CorridorShape(1.2, 0.7, 3.0, 2.0, 0.75)
QUESTION = Question(
    Scenario(Target(0.05, 1.1e-3), Chaser(0.02), SHAPE), 2.0, 1, 2, Goal(0.5, 0.05, (0.0, 1.5)), 1.5, 0.5
)
START = np.array([0.1, 1.5, -0.075, 0.065])


def made(question: Question, start: Floats) -> Document:
    answer = with_hold(question, start, decide(question, start))
    assert answer.held is not None
    out: Document = json.loads(json.dumps(proof_of(question, start, answer)))
    return out


def turned(point: Floats, angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * point[0] - s * point[1], s * point[0] + c * point[1]])


def steps(n: float, dt: float) -> tuple[Floats, Floats]:
    """Transition and held input by one matrix exponential."""
    system = np.zeros((6, 6))
    system[0, 2] = system[1, 3] = system[2, 4] = system[3, 5] = 1.0
    system[2, 0], system[2, 3], system[3, 2] = 3.0 * n * n, 2.0 * n, -2.0 * n
    whole = expm(system * dt)
    return whole[:4, :4], whole[:4, 4:]


def loop_of(question: Question, held: Held) -> tuple[Any, Any]:
    """The reference at a step as a function of the body's angle, solved for as a wave C cos + S sin."""
    target, dt = question.scenario.target, question.dt
    rate, (a, b) = target.tumble_rate, steps(target.mean_motion, dt)
    rows, right = [], []
    for angle in (0.2, 1.9):
        now, then = (np.kron([math.cos(t), math.sin(t)], np.eye(2)) for t in (angle, angle + rate * dt))
        left = np.hstack([a[:, 2:] @ now, b @ now])
        left[2:, :4] -= then
        rows.append(left)
        place = turned(held.point, angle)
        right.append(np.r_[turned(held.point, angle + rate * dt), 0.0, 0.0] - a[:, :2] @ place)
    wave = np.linalg.solve(np.vstack(rows), np.concatenate(right))

    def state(angle: float) -> Floats:
        now = np.kron([math.cos(angle), math.sin(angle)], np.eye(2))
        return np.r_[turned(held.point, angle), now @ wave[:4]]

    def thrust(angle: float) -> Floats:
        return np.asarray(np.kron([math.cos(angle), math.sin(angle)], np.eye(2)) @ wave[4:])

    return state, thrust

"""What an LQR keeps for ever after a flight of `synchronize`: an ellipsoid that holds the flight's end.

The stop of :mod:`safestart.exact.arrival` needs thrust that follows the turn of the body, and says nothing of a flight
that misses its end. Here the thrust is held over the question's steps, and a whole set around a point that turns with
the body stays: a terminal set. docs/theory/hold.md has the theory, :mod:`safestart.control.hold` the sets; planar.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np

from safestart.attitude.body_frame import rotation
from safestart.constraints.corridor import corridor_of
from safestart.control.hold.ellipsoid import distance_left, largest, rooms_of
from safestart.control.hold.hold_lqr import Design
from safestart.control.hold.loop import Hold
from safestart.control.hold.turning_reference import TurningReference
from safestart.dynamics.cwh import Cwh
from safestart.errors import InvalidInput
from safestart.exact.answer import GUARD, Answer, Held, Verdict
from safestart.exact.question import Question
from safestart.model.scenario import Floats
from safestart.optim.prediction import prediction_of

_POSITION, _VELOCITY = 1.0, 0.1
"""Scales of the LQR's weights, m and m/s, as of hold-region; that of the thrust is its limit."""
_SHARE = 1e-9
"""Share of the level left unused, far above rounding."""
_SPARED = 0.5
"""Of the distance that the point itself keeps, the share that the set leaves, if it can."""
_DEEPER = (0.0, 0.25, 0.5, 1.0, 2.0, 4.0)
"""How much farther from the target than the end of the flight points are tried, m."""


def with_hold(question: Question, start: Floats, answer: Answer) -> Answer:
    """A GO of `synchronize` in the plane from ``start`` (4,), LVLH, with the set that holds its end, if one does."""
    if question.goal is None or answer.verdict is not Verdict.GO or answer.thrust is None:
        return answer
    motion, steps = Cwh(question.scenario.target.mean_motion), len(answer.thrust)
    end = prediction_of(motion, question.dt, steps, 2, 1).flight(start, answer.thrust)[-1, -1]
    return replace(answer, held=held_after(question, end, steps * question.dt))


def held_after(question: Question, state: Floats, time: float) -> Held | None:
    """The set with the largest margin for the end ``state`` (4,), LVLH, at ``time`` (s); None where none holds it."""
    angle = question.scenario.target.tumble_rate * time
    place = rotation(angle).T @ state[:2]
    found = [held for point in _points(question, place) if (held := _held(question, point, state, angle))]
    return max(found, key=lambda held: held.margin, default=None)


def _points(question: Question, place: Floats) -> Iterator[Floats]:
    """Where the reference may be, in the body frame, m: by a face there is no room for errors."""
    for more in _DEEPER:
        yield np.array([place[0], place[1] + more])
        yield np.array([0.0, place[1] + more])
    yield np.array(question.hold)


def _held(question: Question, point: Floats, state: Floats, angle: float) -> Held | None:
    """The set around one point."""
    try:
        hold = _loop(question, *point.tolist())
    except InvalidInput:
        # The target turns too far in a step, or the weights have no solution.
        return None
    error = state - hold.reference.at(angle)[0]
    rooms = rooms_of(hold, question.speed_limit)
    most, _ = largest(hold, rooms)
    least = float(error @ hold.cost @ error) * (1.0 + _SHARE) + 1e-12 * most
    if least > most * (1.0 - _SHARE):
        return None
    low, high = least, most * (1.0 - _SHARE)
    wanted = _SPARED * distance_left(hold, rooms, 0.0)
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if distance_left(hold, rooms, middle) >= wanted else (low, middle)
    margin = distance_left(hold, rooms, low)
    if margin <= GUARD:
        return None
    return Held(point, -hold.design.gain, hold.cost, low, margin)


def _loop(question: Question, x: float, y: float) -> Hold:
    scenario = question.scenario
    most, target = scenario.chaser.max_acceleration, scenario.target
    reference = TurningReference.of(np.array([x, y]), target.tumble_rate, target.mean_motion, question.dt)
    return Hold.of(
        _design(target.mean_motion, question.dt, most), reference, corridor_of(scenario.corridor), most
    )


@lru_cache(maxsize=16)
def _design(mean_motion: float, step: float, most: float) -> Design:
    return Design.of(mean_motion, step, _POSITION, _VELOCITY, most)

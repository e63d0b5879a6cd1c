"""Failures of a burn with a duration, as sets of states at its planned time and the window in which the chaser drifts.

A burn that begins t late and lasts for u gives, as a state at its planned time, with f of
:mod:`safestart.missed_burn.pushed`,

    F(t, u) a = int_t^{t+u} f(s) a ds,     dF/du a = f(t + u) a,   dF/dt a = (f(t + u) - f(t)) a.

Both times are cut into pieces; on a piece F a is its value in the middle, two tangents and a box for the bend. While it
burns the chaser is where it would be if the burn ended right then: so pieces of u up to the whole duration cover its
path, each in its own window of time, and for the burn that ends early by failure, for the whole horizon after it.

About the true Earth every set lies near a reference flight. One with a part of the burn is far from that with all of
it: a burn that ends early has several references.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from safestart.dynamics.burn import frame
from safestart.missed_burn.earth.motion import drift_after
from safestart.missed_burn.plan import Burn, Question, duration_of
from safestart.missed_burn.pushed import CwhPushed, EarthPushed, Pushed
from safestart.missed_burn.sets import Case, StateSet, Thrust, pieces, shell

Piece = tuple[float, float]
_UP = 1.0 + 1e-15
_STILL: Piece = (0.0, 0.0)
_APART = 0.02
"""References of a burn that ends early are so many m/s apart, as long as there are no more than:"""
_MOST_REFERENCES = 8


@dataclass(frozen=True, slots=True)
class _Shape:
    """Sizes between ``least`` and ``greatest`` times the planned thrust, within ``angle`` rad of it, in a burn; its
    errors may vary by ``unsteady`` m/s^2 while it burns."""

    least: float
    greatest: float
    angle: float
    unsteady: float


def finite_cases(question: Question, k: int, before: StateSet) -> tuple[StateSet, list[Case]]:
    """The set after burn ``k`` as planned, and all its cases; ``before``: the set at its time, inertial where the
    question is about the true Earth."""
    burn, failures, errors = question.plan.burns[k], question.failures, question.errors
    share, angle, whole = errors.thrust_share, errors.thrust_angle, burn.duration
    unsteady = burn.thrust * float(np.hypot(*shell(1.0 - share, 1.0 + share, angle)[1:]))
    plain = _Shape(1.0 - share, 1.0 + share, angle, unsteady)
    shorter = pieces(whole, burn.thrust)
    full: Piece = (whole, whole)
    known: dict[float, Pushed] = {}

    def pushed(share: float) -> Pushed:
        found = known.get(share)
        if found is None:
            longest = (failures.late + whole + failures.stuck) * _UP**4
            found = known[share] = (
                CwhPushed(question.plan.mean_motion)
                if question.earth is None
                else EarthPushed(drift_after(question, k, share), longest)
            )
        return found

    made = _burning(before, burn, k, pushed(1.0), _STILL, full, plain)
    out = [_case(question, made, k, "made", _STILL, full, 1.0, long=True)]

    def add(kind: str, late: Piece, on: Piece, shape: _Shape, share: float = 1.0, *, long: bool) -> None:
        state = _burning(before, burn, k, pushed(share), late, on, shape)
        out.append(_case(question, state, k, kind, late, on, share, long=long))

    references = 1 if question.earth is None else min(math.ceil(burn.size / _APART), _MOST_REFERENCES)
    for on in shorter:
        near = math.floor(0.5 * (on[0] + on[1]) / whole * references)
        add("cut", _STILL, on, plain, (near + 0.5) / references, long=True)
    shapes: list[tuple[str, _Shape]] = []
    if failures.partial:
        shapes.append(("partial", _Shape(0.0, 1.0 + share, angle, unsteady)))
    if failures.misdirected > 0.0:
        wide = min(angle + failures.misdirected, math.pi)
        shapes.append(("misdirected", _Shape(1.0 - share, 1.0 + share, wide, unsteady)))
    for kind, shape in shapes:
        share = 0.5 if kind == "partial" else 1.0
        add(kind, _STILL, full, shape, share, long=True)
        for on in shorter:
            add(kind, _STILL, on, shape, share, long=False)
    for late in pieces(failures.late, pushed(1.0).rates(0.0)[1][0] * burn.size):
        add("late", late, full, plain, long=True)
        for on in shorter:
            add("late", late, on, plain, long=False)
    for over in pieces(failures.stuck, burn.thrust):
        on = (whole + over[0], whole + over[1])
        state = _burning(before, burn, k, pushed(1.0), _STILL, on, plain)
        case = _case(question, state, k, "stuck", _STILL, on, 1.0, long=True)
        out.append(replace(case, first=over[0], last=over[1]))
    return made, out


def _case(
    question: Question,
    state: StateSet,
    k: int,
    kind: str,
    late: Piece,
    on: Piece,
    share: float,
    *,
    long: bool,
) -> Case:
    """The case with its window: from the end of the burn on, or no longer than the burn may last."""
    ends = (late[1] + on[1]) * _UP
    until = duration_of(question, kind, k, ends) if long else ends
    thrust = Thrust(on[0], on[1], (late[0] + on[0]) / _UP)
    return state.case(kind, k, question.plan.burns[k].time, until, late, thrust, share)


def _burning(
    before: StateSet, burn: Burn, k: int, pushed: Pushed, late: Piece, on: Piece, shape: _Shape
) -> StateSet:
    """The set before the burn, and what the burn adds."""
    state = before.copy()
    late_at, late_by = 0.5 * (late[0] + late[1]), 0.5 * (late[1] - late[0])
    on_at, on_by = 0.5 * (on[0] + on[1]), 0.5 * (on[1] - on[0])
    along, one, two = frame(np.array(burn.impulse))
    middle, half, across = shell(shape.least, shape.greatest, shape.angle)
    size, most, longest = burn.thrust, burn.thrust * shape.greatest, late[1] + on[1]
    gives = pushed.total(late_at + on_at) - pushed.total(late_at)
    state.centre = state.centre + gives @ (middle * size * along)
    if half > 0.0:
        state.block([gives @ (half * size * along)], "along", k)
    if across > 0.0:
        # Across the burn: u/u_2 of what it gives in its longest time u_2, but for the chord's error, below.
        given = pushed.total(late_at + on[1]) - pushed.total(late_at)
        state.block([given @ (across * size * one), given @ (across * size * two)], "across", k)
    end, begin = pushed.at(late_at + on_at), pushed.at(late_at)
    if late_by > 0.0:
        state.block([late_by * ((end - begin) @ (most * along))], "piece", k)
    if on_by > 0.0:
        state.block([on_by * (end @ (most * along))], "on", k)
    slow, slower = pushed.rates(longest)
    bend = most * (0.5 * late_by**2 * on[1] * slower + (late_by * on_by + 0.5 * on_by**2) * slow)
    # What lies across the burn moves with the delay, too; errors that vary while it burns.
    chord = 0.125 * on[1] ** 2 if on_by > 0.0 else 0.0
    loose = size * across * (late_by * on[1] + chord) * slow
    unsteady = 0.5 * on[1] ** 2 * shape.unsteady * slow
    state.box(bend + loose + unsteady + most * pushed.loose(on[1]), "bend")
    return state

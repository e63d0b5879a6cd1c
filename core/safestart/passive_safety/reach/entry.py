"""When mode 1 ends: a proved period in which every start enters the guard, and the crossing sets.

Octagon: each face that may be the crossed one gets its own branch; a start's true entry is in at least one of them.
Circle: one branch. With the outward normal h at the nominal crossing and s the component of the position across it,
|p| = R means h.p = sqrt(R^2 - s^2) where h.p > 0, hence h.p in R - [0, s_max^2/(R + sqrt(R^2 - s_max^2))]: a plane with
a sag, which is one more symbol; the crossing set bounds s, more tightly in each round.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.model.scenario import Floats
from safestart.passive_safety.model import matrix
from safestart.passive_safety.reach.crossing import Crossing, Passage, cross_plane
from safestart.passive_safety.reach.tube import Tube
from safestart.passive_safety.switching_guard import (
    COMPASS_STRETCH,
    FACE_LIMITS,
    FACE_NAMES,
    FACES,
    GAP_GUARD,
    Guard,
    supports,
)

_SAG_ROUNDS = 3
_HAIR = 1e-9


@dataclass(frozen=True, slots=True)
class Entry:
    """When mode 1 ends: ``first`` .. ``last`` (min), its ``branches``; ``reason`` if that was not proved.

    Without branches and without a reason no start enters before the tube ends.
    """

    first: float
    last: float
    branches: tuple[Crossing, ...]
    reason: str = ""


def rows_of(faces: Floats) -> Floats:
    """Directions (r, 2) of the plane as rows (r, 4) on the state."""
    return np.hstack([faces, np.zeros_like(faces)])


def find_entry(tube: Tube, centre: Floats, gens: Floats, horizon: float, guard: Guard) -> Entry:
    """Entry of the mode-1 ``tube`` (of the starts ``centre`` (4,), ``gens`` (g, 4)) into the ``guard``.

    ``horizon`` (min): later entries do not matter.
    """
    faces, limits = supports(guard)
    rows = rows_of(faces)
    outside = (-tube.upper(-rows) > limits * (1.0 + _HAIR)).any(axis=1)
    if outside.all():
        return Entry(np.inf, np.inf, ())
    first = int(np.argmax(~outside))
    if tube.time(first) >= horizon:
        return Entry(np.inf, np.inf, ())
    inside = limits / COMPASS_STRETCH if guard is Guard.CIRCLE else limits
    last = first + 1
    while last <= tube.steps and not (tube.node_upper(rows, last) < inside * (1.0 - _HAIR)).all():
        last += 1
    if last > tube.steps:
        return Entry(
            tube.time(first), np.inf, (), f"not every start is proved to enter the guard {guard.value}"
        )
    find = _through_circle if guard is Guard.CIRCLE else _through_faces
    return find(tube, centre, gens, first, last)


def _through_faces(tube: Tube, centre: Floats, gens: Floats, first: int, last: int) -> Entry:
    rows = rows_of(FACES)
    low, high = tube.time(first), tube.time(last)
    above = tube.upper(rows)
    branches = []
    # A start enters when it meets its last face; every face that may be met between first and last is a branch.
    for face in np.flatnonzero((above[first:last] >= FACE_LIMITS).any(axis=0)):
        fall = tube.upper((rows[face] @ matrix(tube.motion))[None, :])[first:last]
        if not (fall < 0.0).all():
            return Entry(low, high, (), f"face {FACE_NAMES[face]} is not proved to be crossed once only")
        heights = tube.centre[first : last + 1] @ rows[face] - FACE_LIMITS[face]
        passage = _passage(tube, centre, gens, first, last, heights)
        branches.append(cross_plane(passage, FACE_NAMES[face], FACES[face], float(FACE_LIMITS[face])))
    return Entry(low, high, tuple(branches))


def _through_circle(tube: Tube, centre: Floats, gens: Floats, first: int, last: int) -> Entry:
    low, high = tube.time(first), tube.time(last)
    places = tube.centre[first : last + 1, :2]
    heights = np.hypot(*places.T) - GAP_GUARD
    passage = _passage(tube, centre, gens, first, last, heights)
    times = np.linspace(low, high, len(places))
    nominal = np.array([np.interp(passage.middle, times, places[:, k]) for k in range(2)])
    normal = nominal / np.hypot(*nominal)
    across = np.array([-normal[1], normal[0]])
    period = tube.upper(rows_of(np.stack([-normal, across, -across])))[first:last].max(axis=0)
    fall = tube.upper((rows_of(normal[None])[0] @ matrix(tube.motion))[None, :])[first:last]
    if not (period[0] < 0.0 and max(period[1:]) < GAP_GUARD and (fall < 0.0).all()):
        return Entry(low, high, (), "the starts enter the guard circle from too many sides")
    side = float(max(period[1:]))
    for _ in range(_SAG_ROUNDS):
        deepest = side**2 / (GAP_GUARD + math.sqrt(GAP_GUARD**2 - side**2))
        sag = 0.5 * deepest + _HAIR
        crossing = cross_plane(passage, "circle", normal, GAP_GUARD - 0.5 * deepest, sag)
        reach = abs(float(across @ crossing.centre[:2])) + float(np.abs(crossing.gens[:, :2] @ across).sum())
        side = min(side, reach + _HAIR)
    return Entry(low, high, (crossing,))


def _passage(tube: Tube, centre: Floats, gens: Floats, first: int, last: int, heights: Floats) -> Passage:
    """``heights`` (last - first + 1,) of the nominal start over the guard, to expand near its root."""
    low, high = tube.time(first), tube.time(last)
    # The approximate nominal root: any time of the period is valid, and this one keeps the remainder small.
    middle = float(np.interp(0.0, -heights, np.linspace(low, high, last - first + 1)))
    second, third = tube.second[first:last].max(axis=0), tube.third[first:last].max(axis=0)
    return Passage(tube.motion, centre, gens, low, middle, high, second, third, tube.noise[last])

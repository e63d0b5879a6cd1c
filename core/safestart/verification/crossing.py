"""From mode 1 to mode 2: every state on the guard octagon at the first entry, with the time of crossing.

Each face that may be the crossed one gets its own branch; a start's true entry is in at least one of them. Within a
branch the flow is expanded about one time t*: with z = z(t*), f = A c*, delta = t_c - t* and e the remainder,

    z(t_c) = z + delta f + e,   |e| <= D |A G*| 1 + D^2/2 sup |A^2 z|,   |delta| <= D,

and h.z(t_c) = b gives delta, affine in the symbols of the start and in e; then z(t_c) is the projection of z + e
along f onto the face. So the crossing time is one more affine coordinate of the crossing set.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.scenario import Floats
from safestart.verification.flow import flow_at
from safestart.verification.model import FACE_LIMITS, FACE_NAMES, FACES, Mode, matrix
from safestart.verification.rounding import SLACK, UP
from safestart.verification.tube import Tube

_ROUNDS = 4


@dataclass(frozen=True, slots=True)
class Crossing:
    """Crossing set of one face: ``centre`` (4,), ``gens`` (g + 4, 4), the last four a box of remainders.

    Crossing time (min): ``time`` + ``time_gens`` (g,) . xi +- ``time_radius``, and in [``first``, ``last``].
    """

    face: int
    centre: Floats
    gens: Floats
    time: float
    time_gens: Floats
    time_radius: float
    first: float
    last: float

    @property
    def name(self) -> str:
        """Name of the face."""
        return FACE_NAMES[self.face]


@dataclass(frozen=True, slots=True)
class Entry:
    """When mode 1 ends: ``first`` .. ``last`` (min), its ``branches``; ``reason`` where that was not proved.

    Without branches and without a reason no start enters before the tube ends.
    """

    first: float
    last: float
    branches: tuple[Crossing, ...]
    reason: str = ""


def _rows(faces: Floats) -> Floats:
    """Faces (r, 2) as rows (r, 4) on the state."""
    return np.hstack([faces, np.zeros_like(faces)])


def find_entry(tube: Tube, centre: Floats, gens: Floats, horizon: float, remainder: float = 1.0) -> Entry:
    """Entry of the mode-1 ``tube`` (of the starts ``centre`` (4,), ``gens`` (g, 4)) into the octagon.

    ``horizon`` (min): entries later than that do not matter. ``remainder`` scales e; anything below 1 is unsound
    and serves the mutation tests.
    """
    rows = _rows(FACES)
    above, below = tube.upper(rows), -tube.upper(-rows)
    outside = (below > FACE_LIMITS).any(axis=1)
    if outside.all():
        return Entry(np.inf, np.inf, ())
    first = int(np.argmax(~outside))
    if tube.time(first) >= horizon:
        return Entry(np.inf, np.inf, ())
    last = first + 1
    while last <= tube.steps and not (tube.node_upper(rows, last) < FACE_LIMITS).all():
        last += 1
    if last > tube.steps:
        return Entry(tube.time(first), np.inf, (), "not every start is proved to enter the guard octagon")
    low, high = tube.time(first), tube.time(last)
    branches = []
    # A start enters where its last face is met, and every face that may be met between first and last is a branch.
    for face in np.flatnonzero((above[first:last] >= FACE_LIMITS).any(axis=0)):
        fall = tube.upper((rows[face] @ matrix(Mode.FAR))[None, :])[first:last]
        if not (fall < 0.0).all():
            return Entry(low, high, (), f"face {FACE_NAMES[face]} is not proved to be crossed once only")
        heights = tube.centre[first : last + 1] @ rows[face] - FACE_LIMITS[face]
        # The nominal root, roughly: any time of the period would do, this one keeps the remainder small.
        middle = float(np.interp(0.0, -heights, np.linspace(low, high, last - first + 1)))
        second = tube.second[first:last].max(axis=0)
        branches.append(_branch(centre, gens, int(face), (low, middle, high), second, remainder))
    return Entry(low, high, tuple(branches))


def _branch(
    centre: Floats,
    gens: Floats,
    face: int,
    times: tuple[float, float, float],
    second: Floats,
    remainder: float,
) -> Crossing:
    """Crossing set of one face; ``times`` are first, expansion, last; ``second`` (4,) bounds |A^2 z| between them."""
    low, middle, high = times
    row, limit, a = _rows(FACES)[face], float(FACE_LIMITS[face]), matrix(Mode.FAR)
    phi, _ = flow_at(Mode.FAR, middle)
    nominal, spread = phi @ centre, gens @ phi.T
    flow = a @ nominal
    fall = float(row @ flow)
    size = np.abs(phi) @ (np.abs(centre) + np.abs(gens).sum(axis=0))
    size = size + np.abs(a) @ size * (1.0 + high - low)
    offset = (limit - float(row @ nominal)) / fall
    slopes = -(spread @ row) / fall
    widest = max(high - middle, middle - low)
    for _ in range(_ROUNDS):
        error = widest * np.abs(spread @ a.T).sum(axis=0) + 0.5 * widest**2 * second
        error = remainder * UP * error + SLACK * size
        radius = UP * float(np.abs(row) @ error) / abs(fall) + SLACK * (1.0 + abs(middle) + widest)
        widest = min(widest, UP * (abs(offset) + float(np.abs(slopes).sum()) + radius))
    project = np.eye(4) - np.outer(flow, row) / fall
    # A second helping of round-off for the projection itself, whose entries are |f| |h| / |h f| at most.
    stretch = np.abs(np.eye(4)) + np.outer(np.abs(flow), np.abs(row)) / abs(fall)
    box = UP * (np.abs(project) @ error) + SLACK * (stretch @ (size + abs(limit)))
    return Crossing(
        face,
        nominal + flow * offset,
        np.vstack([spread @ project.T, np.diag(box)]),
        middle + offset,
        slopes,
        radius,
        low,
        high,
    )

"""Does a convex polygon, moved by q, meet the corridor cone? Exactly, by separating directions."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import cache

import numpy as np

from safestart.model.scenario import Floats
from safestart.sets.cone import directions
from safestart.sets.meet_kernel import meet_margins

NARROW = 1e-12
"""Width (rad) below which two breakpoints count as one (generators that are parallel up to round-off)."""


@dataclass(frozen=True, slots=True)
class MeetArc:
    """Support function, over the corridor's dual arc, of "polygon minus corridor".

    Between ``angles[j]`` and ``angles[j + 1]`` (ascending, m + 1 of them, rad) it is the linear function
    d . vertices[j] (m, 2), metres: the vertices already hold the port's half-width and the hold radius.
    """

    angles: Floats
    vertices: Floats

    @classmethod
    def of(cls, angles: Floats, vertices: Floats) -> MeetArc:
        """Drop pieces too narrow to matter, so that neighbours are true neighbours."""
        wide = np.diff(angles) > NARROW
        return cls(np.append(angles[:-1][wide], angles[-1]), vertices[wide])

    def margin(self, positions: Floats) -> Floats:
        """Margin (P,) in metres of the polygon moved by each of ``positions`` (P, 2), body axes; exact."""
        out = np.empty(len(positions))
        meet_margins(np.ascontiguousarray(positions), directions(self.angles), self.vertices, out)
        return out


@cache
def warm() -> float:
    """Compile the kernel (or load it from Numba's cache) once per process; seconds it took the first time."""
    start = time.perf_counter()
    MeetArc(np.array([-0.5, 0.5]), np.zeros((1, 2))).margin(np.zeros((1, 2)))
    return time.perf_counter() - start

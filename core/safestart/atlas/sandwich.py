"""Inner and outer polygon of a planar convex set that is known only by its support.

For a direction g the oracle gives a point of the set farthest along g and a valid half-plane g . p <= h.
Points span the inner polygon, half-planes the outer one; between an edge of the inner polygon and the two half-planes
of its ends lies a triangle, and the next direction is the normal of the edge whose triangle is the largest. The area
between the polygons falls as 1 / n^2.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from safestart.model.scenario import Floats

Evidence = TypeVar("Evidence")

_START = tuple(2.0 * math.pi * k / 4 for k in range(4))


@dataclass(frozen=True, slots=True)
class Support(Generic[Evidence]):
    """The oracle's answer: unit ``direction`` (2,), ``point`` (2,) of the set, ``bound`` h, and the proof of both."""

    direction: Floats
    point: Floats
    bound: float
    evidence: Evidence


@dataclass(frozen=True, slots=True)
class Sandwich(Generic[Evidence]):
    """Supports counter-clockwise by direction; ``inner_area`` and ``outer_area`` in the unit of the points squared."""

    supports: tuple[Support[Evidence], ...]
    inner_area: float
    outer_area: float

    @property
    def relative_gap(self) -> float:
        """(outer - inner) / outer area; 0 for an empty set."""
        return (self.outer_area - self.inner_area) / self.outer_area if self.outer_area > 0.0 else 0.0


def refine(oracle: Callable[[Floats], Support[Evidence]], tolerance: float, most: int) -> Sandwich[Evidence]:
    """Ask directions until the relative gap is at most ``tolerance`` or ``most`` were asked."""
    known: list[tuple[float, Support[Evidence]]] = [(angle, oracle(_unit(angle))) for angle in _START]
    while True:
        triangles = [_triangle(known, k) for k in range(len(known))]
        inner = _area(np.array([support.point for _, support in known]))
        outer = max(inner, _area(_outer([support for _, support in known])))
        worst = max(range(len(known)), key=lambda k: triangles[k][0])
        closed = outer <= 0.0 or (outer - inner) <= tolerance * outer
        if closed or len(known) >= most or triangles[worst][0] <= 0.0:
            return Sandwich(tuple(support for _, support in known), inner, outer)
        angle = triangles[worst][1]
        known.insert(worst + 1, (angle, oracle(_unit(angle))))


def _outer(supports: Sequence[Support[Evidence]]) -> Floats:
    """Corners (n, 2) of the intersection of all half-planes with a square around them."""
    half = 4.0 * max(1.0, *(abs(support.bound) for support in supports))
    polygon = half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    for support in supports:
        beyond = polygon @ support.direction - support.bound
        out = []
        for a, b, over, after in zip(
            polygon, np.roll(polygon, -1, 0), beyond, np.roll(beyond, -1), strict=True
        ):
            if over <= 0.0:
                out.append(a)
            if over * after < 0.0:
                out.append(a + (over / (over - after)) * (b - a))
        if len(out) < 3:
            return np.zeros((1, 2))
        polygon = np.array(out)
    return polygon


def _unit(angle: float) -> Floats:
    return np.array([math.cos(angle), math.sin(angle)])


def _triangle(known: Sequence[tuple[float, Support[Evidence]]], k: int) -> tuple[float, float]:
    """Area between edge k and its two half-planes, and the angle of the next direction to ask there."""
    low, a = known[k]
    high, b = known[(k + 1) % len(known)]
    if high <= low:
        high += 2.0 * math.pi
    middle = 0.5 * (low + high)
    edge = b.point - a.point
    length = math.hypot(edge[0], edge[1])
    corner = _corner(a, b)
    if corner is None:
        return 0.0, middle
    ahead = corner - a.point
    area = 0.5 * abs(edge[0] * ahead[1] - edge[1] * ahead[0])
    if length <= 1e-12:
        # Both ends are one point: a corner of the set, which no direction in between can refine.
        return 0.0, middle
    normal = math.atan2(-edge[0], edge[1])
    while normal < low:
        normal += 2.0 * math.pi
    # The edge's normal separates best; if rounding puts it outside the sector, take the middle.
    inside = low + 1e-9 < normal < high - 1e-9
    return area, normal if inside else middle


def _corner(a: Support[Evidence], b: Support[Evidence]) -> Floats | None:
    """Where the two half-planes' lines cross; None when they are (nearly) parallel."""
    matrix = np.array([a.direction, b.direction])
    if abs(matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0]) < 1e-9:
        return None
    corner: Floats = np.linalg.solve(matrix, np.array([a.bound, b.bound]))
    return corner


def _area(points: Floats) -> float:
    """Shoelace area of a counter-clockwise polygon (n, 2)."""
    x, y = points[:, 0], points[:, 1]
    return 0.5 * float(abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))

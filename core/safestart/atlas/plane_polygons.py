"""Convex polygons of a plane: their area, what a half-plane leaves of them, the corner furthest beyond another."""

from __future__ import annotations

import numpy as np

from safestart.model.scenario import Floats


def area(polygon: Floats) -> float:
    """Of a polygon (K, 2)."""
    if len(polygon) < 3:
        return 0.0
    x, y = polygon[:, 0], polygon[:, 1]
    return 0.5 * float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def clipped(polygon: Floats, level: float, slope: Floats) -> Floats:
    """The part of a convex polygon (K, 2) where level + slope . u >= 0."""
    values = level + polygon @ slope
    out = []
    for a, b, va, vb in zip(polygon, np.roll(polygon, -1, axis=0), values, np.roll(values, -1), strict=True):
        if va >= 0.0:
            out.append(a)
        if va * vb < 0.0:
            out.append(a + (va / (va - vb)) * (b - a))
    return np.array(out).reshape(-1, 2)


def furthest(outer: Floats, inner: Floats) -> Floats:
    """The corner of the outer polygon that is furthest beyond an edge of the inner one."""
    if len(inner) < 3:
        away = np.linalg.norm(outer - inner[0], axis=1)
        return np.asarray(outer[int(np.argmax(away))])
    edge = np.roll(inner, -1, axis=0) - inner
    normal = np.column_stack([edge[:, 1], -edge[:, 0]]) / np.linalg.norm(edge, axis=1)[:, None]
    beyond = ((outer[:, None] - inner) * normal).sum(axis=2)
    # Weighted with the edge's length: about the area between.
    return np.asarray(outer[int(np.argmax((beyond * np.linalg.norm(edge, axis=1)).max(axis=1)))])

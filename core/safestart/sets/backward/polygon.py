"""Convex polygons by their vertices, counter-clockwise; a point and a segment are polygons, None is the empty set."""

from __future__ import annotations

import numpy as np

from safestart.model.scenario import Floats


def hull(points: Floats) -> Floats:
    """Vertices (V, 2) of the convex hull of ``points`` (P, 2), counter-clockwise, by Andrew's chain."""
    ordered = np.unique(points, axis=0)
    if len(ordered) <= 2:
        return ordered

    def chain(sequence: Floats) -> list[Floats]:
        kept: list[Floats] = []
        for point in sequence:
            while len(kept) > 1 and _cross(kept[-1] - kept[-2], point - kept[-1]) <= 0.0:
                kept.pop()
            kept.append(point)
        return kept[:-1]

    return np.array(chain(ordered) + chain(ordered[::-1]))


def _cross(left: Floats, right: Floats) -> float:
    return float(left[0] * right[1] - left[1] * right[0])


def box(centre: Floats, half: Floats) -> Floats | None:
    """The box of half-widths ``half`` (2,), all finite; empty if one is negative."""
    if (half < 0.0).any():
        return None
    return hull(centre + half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]))


def plus(vertices: Floats, generators: Floats) -> Floats:
    """Minkowski sum with the zonotope of ``generators`` (2, m)."""
    for generator in generators.T:
        if generator.any():
            vertices = hull(np.concatenate([vertices - generator, vertices + generator]))
    return vertices


def faces(vertices: Floats) -> tuple[Floats, Floats]:
    """Unit normals (F, 2) and offsets (F,) with the polygon = {x : normals @ x <= offsets}."""
    if len(vertices) == 1:
        normals = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    else:
        along = np.roll(vertices, -1, axis=0) - vertices
        normals = np.stack([along[:, 1], -along[:, 0]], axis=1)
        if len(vertices) == 2:
            normals = np.concatenate([normals, along])
        normals = normals / np.hypot(normals[:, 0], normals[:, 1])[:, None]
    return normals, (vertices @ normals.T).max(axis=0)


def minus(vertices: Floats, generators: Floats) -> Floats | None:
    """Pontryagin difference: the points x with x + W inside, W the zonotope of ``generators`` (2, q)."""
    normals, offsets = faces(vertices)
    return cut(vertices, normals, offsets - np.abs(normals @ generators).sum(axis=1))


def cut(vertices: Floats, normals: Floats, offsets: Floats) -> Floats | None:
    """The part of the polygon in ``normals`` (F, 2) @ x <= ``offsets`` (F,)."""
    for normal, offset in zip(normals, offsets, strict=True):
        room = offset - vertices @ normal
        if (room >= 0.0).all():
            continue
        if (room < 0.0).all():
            return None
        after, room_after = np.roll(vertices, -1, axis=0), np.roll(room, -1)
        crossing = (room >= 0.0) != (room_after >= 0.0)
        share = room[crossing] / (room[crossing] - room_after[crossing])
        met = vertices[crossing] + share[:, None] * (after[crossing] - vertices[crossing])
        vertices = hull(np.concatenate([vertices[room >= 0.0], met]))
    return vertices


def within(vertices: Floats, half: Floats) -> Floats | None:
    """The part of the polygon in |x_i| <= half_i (2,); inf bounds nothing."""
    normals = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    bounds = np.tile(half, 2)
    kept = np.isfinite(bounds)
    return cut(vertices, normals[kept], bounds[kept])


def area(vertices: Floats | None) -> float:
    """Area; 0 for the empty set."""
    if vertices is None or len(vertices) < 3:
        return 0.0
    moved = vertices - vertices[0]
    after = np.roll(moved, -1, axis=0)
    return 0.5 * float((moved[:, 0] * after[:, 1] - moved[:, 1] * after[:, 0]).sum())


def excess(inner: Floats | None, outer: Floats | None) -> float:
    """How far ``inner`` sticks out of ``outer``, at most over its faces; <= 0: inside; inf: ``outer`` is empty."""
    if inner is None:
        return -np.inf
    if outer is None:
        return np.inf
    normals, offsets = faces(outer)
    return float(((inner @ normals.T).max(axis=0) - offsets).max())

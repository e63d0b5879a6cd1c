"""The member of a set of positions that is nearest to the target, by Gilbert's method with Wolfe's corrections.

The set is the image of centre + sum_k M_k b_k, |b_k|_2 <= 1, under the position rows. Every step finds the member
furthest towards the target, and takes the nearest point of the simplex of all members found so far.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled

_STEPS = 40
_SUBSETS = 15


@compiled()
def nearest(
    rows: Floats,
    centre: Floats,
    offset: Floats,
    columns: Floats,
    still: Floats,
    ends: NDArray[np.int64],
    guess: Floats,
    direction: Floats,
    member: Floats,
) -> float:
    """Distance of the nearest member found.

    ``rows`` (3, 6), ``offset`` (3,) of all positions, ``columns`` (C, 6), ``still`` (S, 3): columns of positions that
    do not move, ``ends`` (K,) of the blocks of both, ``guess`` (3,): a first direction. Writes the ``direction`` (3,)
    with the greatest lower bound seen and the coordinates (C + S,) of the nearest ``member`` in the columns.
    """
    moving = len(columns)
    count = moving + len(still)
    centre3, images = np.empty(3), np.empty((count, 3))
    for i in range(3):
        centre3[i] = offset[i] + _dot6(rows[i], centre)
        for j in range(moving):
            images[j, i] = _dot6(rows[i], columns[j])
        for j in range(moving, count):
            images[j, i] = still[j - moving, i]
    points, coordinates = np.empty((4, 3)), np.empty((4, count))
    weights = np.zeros(4)
    held, best = 0, -np.inf
    at, d = np.empty(3), guess.copy()
    direction[:] = guess
    upper = np.inf
    for _ in range(_STEPS):
        fresh = np.empty(count)
        low = _extreme(d, centre3, images, ends, fresh, at)
        if low > best:
            best = low
            direction[:] = d
        if upper - best <= 1e-6 + 1e-9 * abs(best):
            break
        repeated = False
        for k in range(held):
            repeated = repeated or (np.abs(points[k] - at).max() < 1e-12 * (1.0 + np.abs(at).max()))
        if repeated or held == 4:
            break
        points[held], coordinates[held] = at, fresh
        held += 1
        held = _simplex(points, coordinates, weights, held, at)
        size = math.sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2])
        if size < upper:
            upper = size
            member[:] = 0.0
            for k in range(held):
                member += weights[k] * coordinates[k]
        if size < 1e-9:
            break
        d = at / size
    return upper


@compiled()
def _dot6(q: Floats, m: Floats) -> float:
    total: float = q[0] * m[0] + q[1] * m[1] + q[2] * m[2] + q[3] * m[3] + q[4] * m[4] + q[5] * m[5]
    return total


@compiled()
def _extreme(
    d: Floats, centre: Floats, images: Floats, ends: NDArray[np.int64], fresh: Floats, at: Floats
) -> float:
    """The member with the least value in direction ``d``; returns the value, writes its coordinates and position."""
    value: float = d[0] * centre[0] + d[1] * centre[1] + d[2] * centre[2]
    at[:] = centre
    begin = 0
    for end in ends:
        square = 0.0
        for j in range(begin, end):
            fresh[j] = d[0] * images[j, 0] + d[1] * images[j, 1] + d[2] * images[j, 2]
            square += fresh[j] * fresh[j]
        size = math.sqrt(square)
        for j in range(begin, end):
            fresh[j] = -fresh[j] / size if size > 0.0 else 0.0
            at += fresh[j] * images[j]
        value -= size
        begin = end
    return value


@compiled()
def _simplex(points: Floats, coordinates: Floats, weights: Floats, held: int, at: Floats) -> int:
    """Nearest point ``at`` of the simplex of ``held`` points; keeps the points with weight and returns their number."""
    best, chosen = np.inf, 1
    share, kept = np.zeros(4), np.zeros(4)
    for subset in range(1, _SUBSETS + 1):
        if subset >= 1 << held:
            break
        size = 0
        index = np.zeros(4, dtype=np.int64)
        for k in range(held):
            if subset >> k & 1:
                index[size] = k
                size += 1
        # Least |sum w_k p_k|^2 with sum w_k = 1: the normal equations over the differences to the first point.
        share[:] = 0.0
        if size > 1:
            gram, right = np.empty((size - 1, size - 1)), np.empty(size - 1)
            first = points[index[0]]
            for i in range(size - 1):
                u = points[index[i + 1]] - first
                right[i] = -(u[0] * first[0] + u[1] * first[1] + u[2] * first[2])
                for j in range(size - 1):
                    v = points[index[j + 1]] - first
                    gram[i, j] = u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
            if not _solve(gram, right):
                continue
            share[0] = 1.0
            for i in range(size - 1):
                share[i + 1] = right[i]
                share[0] -= right[i]
        else:
            share[0] = 1.0
        fits = True
        for i in range(size):
            fits = fits and share[i] >= 0.0
        if not fits:
            continue
        x = y = z = 0.0
        for i in range(size):
            x += share[i] * points[index[i], 0]
            y += share[i] * points[index[i], 1]
            z += share[i] * points[index[i], 2]
        square = x * x + y * y + z * z
        if square < best:
            best, chosen = square, subset
            kept[:] = share
            at[0], at[1], at[2] = x, y, z
    size = 0
    for k in range(held):
        if chosen >> k & 1:
            if size != k:
                points[size], coordinates[size] = points[k], coordinates[k]
            weights[size] = kept[size]
            size += 1
    return size


@compiled()
def _solve(matrix: Floats, right: Floats) -> bool:
    """Gauss elimination in place, up to 3 x 3, of a Gram matrix; False if it is nearly singular."""
    size = len(right)
    scale = 0.0
    for i in range(size):
        scale = max(scale, matrix[i, i])
    for i in range(size):
        if matrix[i, i] <= 1e-14 * scale:
            return False
        for k in range(i + 1, size):
            factor = matrix[k, i] / matrix[i, i]
            for j in range(i, size):
                matrix[k, j] -= factor * matrix[i, j]
            right[k] -= factor * right[i]
    for i in range(size - 1, -1, -1):
        for j in range(i + 1, size):
            right[i] -= matrix[i, j] * right[j]
        right[i] /= matrix[i, i]
    return True

"""The least distance of a drifting set to the target, bounded from below at all times and from above by a member.

The set of states at t = 0 is centre + sum_k M_k b_k with |b_k|_2 <= 1: a block of one column is a segment, of two an
ellipse. In CWH motion the positions at t are Phi_p(t) times it. For a unit vector d and q(t) = Phi_p(t)' d,

    distance(t) >= f_d(t) = q . centre - sum_k |M_k' q| - d . z - sum_k |Z_k' d|,

z and Z_k the centre and the blocks of a zone that does not move, and f_d is concave in q. Over [a, b] q differs from
its chord by at most (b - a)^2/8 |q''|, where q'' = P cos n t + Q sin n t has no secular part. So min(f_d(a), f_d(b))
minus the remainder bounds f_d on [a, b]. The intervals with the lowest bounds are halved until the bound meets a member
of the set. docs/theory/hopping.md has the inequalities.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from safestart.missed_burn.kernels.nearest import nearest
from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled

ROUNDING = 1e-12
"""Every bound is lowered by this share of the magnitude of all terms: a hundred times the possible rounding."""

FIRST = 24
"""Intervals at the beginning of a search over a whole horizon."""
Ends = NDArray[np.int64]


@compiled()
def position_rows(n: float, t: float, rows: Floats) -> None:
    """Position rows (3, 6) of the CWH transition over t s."""
    tau = n * t
    s, c = math.sin(tau), math.cos(tau)
    rows[:] = 0.0
    rows[0, 0], rows[0, 3], rows[0, 4] = 4.0 - 3.0 * c, s / n, 2.0 * (1.0 - c) / n
    rows[1, 0], rows[1, 1] = 6.0 * (s - tau), 1.0
    rows[1, 3], rows[1, 4] = -2.0 * (1.0 - c) / n, (4.0 * s - 3.0 * tau) / n
    rows[2, 2], rows[2, 5] = c, s / n


@compiled()
def _bends(n: float, d: Floats, cosine: Floats, sine: Floats) -> None:
    """P and Q (6,) of q'' = P cos n t + Q sin n t."""
    cosine[0], sine[0] = 3.0 * n * n * d[0], -6.0 * n * n * d[1]
    cosine[1], sine[1] = 0.0, 0.0
    cosine[2], sine[2] = -n * n * d[2], 0.0
    cosine[3], sine[3] = -2.0 * n * d[1], -n * d[0]
    cosine[4], sine[4] = 2.0 * n * d[0], -4.0 * n * d[1]
    cosine[5], sine[5] = 0.0, -n * d[2]


@compiled()
def _dot(q: Floats, m: Floats) -> float:
    total: float = q[0] * m[0] + q[1] * m[1] + q[2] * m[2] + q[3] * m[3] + q[4] * m[4] + q[5] * m[5]
    return total


@compiled()
def _spread(q: Floats, columns: Floats, ends: Ends) -> float:
    """sum_k |M_k' q|; ``columns`` (C, 6) of all blocks, ``ends`` (K,) where each block ends."""
    total, begin = 0.0, 0
    for end in ends:
        square = 0.0
        for j in range(begin, end):
            part = _dot(q, columns[j])
            square += part * part
        total += math.sqrt(square)
        begin = end
    return total


@compiled()
def _value(
    n: float, t: float, d: Floats, centre: Floats, columns: Floats, ends: Ends, rows: Floats, q: Floats
) -> float:
    """f_d(t)."""
    position_rows(n, t, rows)
    for j in range(6):
        q[j] = rows[0, j] * d[0] + rows[1, j] * d[1] + rows[2, j] * d[2]
    level: float = _dot(q, centre) - _spread(q, columns, ends)
    return level


@compiled()
def _remainder(
    n: float, d: Floats, centre: Floats, columns: Floats, ends: Ends, p: Floats, q: Floats
) -> float:
    """Bound on |f_d''| along the chord's error, per unit of (b - a)^2 / 8."""
    _bends(n, d, p, q)
    total, begin = math.hypot(_dot(p, centre), _dot(q, centre)), 0
    for end in ends:
        square = 0.0
        for j in range(begin, end):
            one, two = _dot(p, columns[j]), _dot(q, columns[j])
            square += one * one + two * two
        total += math.sqrt(square)
        begin = end
    return total


@compiled()
def _support(d: Floats, offset: Floats, still: Floats, still_ends: Ends) -> float:
    """-d . z - sum_k |Z_k' d|: what the zone takes off the distance in the direction d; ``offset``: -z."""
    total: float = d[0] * offset[0] + d[1] * offset[1] + d[2] * offset[2]
    begin = 0
    for end in still_ends:
        square = 0.0
        for j in range(begin, end):
            part = d[0] * still[j, 0] + d[1] * still[j, 1] + d[2] * still[j, 2]
            square += part * part
        total -= math.sqrt(square)
        begin = end
    return total


@compiled()
def _magnitude(n: float, t: float, centre: Floats, columns: Floats) -> float:
    """Sum of the sizes of all terms of f_d up to t."""
    tau = n * t
    total = 0.0
    for j in range(6):
        size = abs(centre[j])
        for k in range(len(columns)):
            size += abs(columns[k, j])
        weight = 7.0 + 6.0 * (1.0 + tau) if j == 0 else 1.0 if j < 3 else (8.0 + 3.0 * tau) / n
        total += weight * size
    return total


@compiled()
def least_distance(
    n: float,
    begin: float,
    horizon: float,
    centre: Floats,
    columns: Floats,
    ends: Ends,
    offset: Floats,
    still: Floats,
    still_ends: Ends,
    strays: Floats,
    first: int,
    enough: float,
    below: float,
    tolerance: float,
    most: int,
) -> tuple[float, float, float, Floats, Floats, int]:
    """Bounds on the least distance to a zone over [begin, horizon].

    ``offset`` (3,): the zone's centre, negative; ``still`` (S, 3) and ``still_ends``: its blocks. ``strays`` (L, 3):
    how far the true motion may be from the linear one, per axis, up to the end of each of L equal parts of [0,
    horizon]; not decreasing. ``first``: intervals at the beginning. The search ends when the lower bound reaches
    ``enough``, a member is nearer than ``below``, both bounds agree to ``tolerance``, or ``most`` intervals are used.
    Returns the lower bound, the least distance of a member with its time and its coordinates (C + S,) in the columns,
    and the intervals (N, 5): begin, end, direction.
    """
    cells = np.empty((most, 5))
    bounds = np.empty(most)
    sharp = np.zeros(most, dtype=np.bool_)
    rows, q, p = np.empty((3, 6)), np.empty(6), np.empty(6)
    both = len(columns) + len(still)
    d, member, best = np.empty(3), np.empty(both), np.zeros(both)
    all_ends = np.concatenate((ends, still_ends + len(columns)))
    loss = ROUNDING * (_magnitude(n, horizon, centre, columns) + np.abs(offset).sum() + np.abs(still).sum())
    # ``goal``: the best possible bound, given how far the true motion may stray.
    count, upper, goal, when = 0, np.inf, np.inf, 0.0
    for k in range(first):
        cells[k, 0] = begin + (horizon - begin) * k / first
        cells[k, 1] = begin + (horizon - begin) * (k + 1) / first
    cells[0, 0], cells[first - 1, 1] = begin, horizon
    count = first
    fresh = 0
    while True:
        # Bounds of the new intervals: first by the direction to the centre, which needs no search.
        for k in range(fresh, count):
            middle = 0.5 * (cells[k, 0] + cells[k, 1])
            position_rows(n, middle, rows)
            size = 0.0
            for i in range(3):
                d[i] = offset[i] + _dot(rows[i], centre)
                size += d[i] * d[i]
            size = math.sqrt(size)
            for i in range(3):
                d[i] = d[i] / size if size > 0.0 else 1.0 if i == 0 else 0.0
            cells[k, 2:] = d
            bounds[k] = _bound(n, horizon, cells[k], centre, columns, ends, strays, rows, q, p) - loss
            bounds[k] += _support(cells[k, 2:], offset, still, still_ends)
            sharp[k] = False
        fresh = count
        worst = int(np.argmin(bounds[:count]))
        low = bounds[worst]
        if low >= enough or low >= goal - tolerance or upper < below:
            break
        if not sharp[worst]:
            sharp[worst] = True
            middle = 0.5 * (cells[worst, 0] + cells[worst, 1])
            position_rows(n, middle, rows)
            distance = nearest(rows, centre, offset, columns, still, all_ends, cells[worst, 2:], d, member)
            if distance < upper:
                upper, when = distance, middle
                best[:] = member
            goal = min(goal, distance - _stray(middle, horizon, d, strays))
            one, two = cells[worst].copy(), 0.0
            one[2:] = d
            two = _bound(n, horizon, one, centre, columns, ends, strays, rows, q, p) - loss
            two += _support(d, offset, still, still_ends)
            if two > low:
                cells[worst], bounds[worst] = one, two
            continue
        if count >= most:
            break
        middle = 0.5 * (cells[worst, 0] + cells[worst, 1])
        cells[count, 0], cells[count, 1] = middle, cells[worst, 1]
        cells[worst, 1] = middle
        # Bound both halves again, with the whole interval's direction where it is still good enough.
        for k in (worst, count):
            bounds[k] = -np.inf
        cells[count, 2:] = cells[worst, 2:]
        for k in (worst, count):
            bounds[k] = _bound(n, horizon, cells[k], centre, columns, ends, strays, rows, q, p) - loss
            bounds[k] += _support(cells[k, 2:], offset, still, still_ends)
            sharp[k] = False
        count += 1
        fresh = count
    return low, upper, when, best, cells[:count].copy(), count


@compiled()
def _bound(
    n: float,
    horizon: float,
    cell: Floats,
    centre: Floats,
    columns: Floats,
    ends: Ends,
    strays: Floats,
    rows: Floats,
    q: Floats,
    p: Floats,
) -> float:
    """Lower bound on the distance over one interval, before the allowance for rounding."""
    d, span = cell[2:], cell[1] - cell[0]
    low: float = min(
        _value(n, cell[0], d, centre, columns, ends, rows, q),
        _value(n, cell[1], d, centre, columns, ends, rows, q),
    )
    low -= 0.125 * span * span * _remainder(n, d, centre, columns, ends, p, q)
    low -= _stray(cell[1], horizon, d, strays)
    return low


@compiled()
def _stray(t: float, horizon: float, d: Floats, strays: Floats) -> float:
    """Largest loss of distance of the true motion in direction d up to t."""
    parts = len(strays)
    # Rounding of the quotient must not choose the previous part.
    part = max(min(math.ceil(t / horizon * parts + 1e-9), parts) - 1, 0)
    lost: float = abs(d[0]) * strays[part, 0] + abs(d[1]) * strays[part, 1] + abs(d[2]) * strays[part, 2]
    return lost

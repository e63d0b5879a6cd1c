"""The least distance of a drifting set, where the transition is known at equally spaced times only.

The set is a path and, off from it, a centre and blocks. Each image y has y'' = G(t) y with |G| <= K (the path by the
mean of gravity's gradient between both bodies), so over [a, b] y differs from its chord by at most k sup |y|, where
k = K (b - a)^2/8, and so sup |y| <= max(|y(a)|, |y(b)|) / (1 - k). For a unit vector d, inertial and fixed,

    distance >= min(f_d(a), f_d(b)) - k/(1 - k) sum of max(|y(a)|, |y(b)|) over path, centre, blocks,

f_d as in :mod:`safestart.missed_burn.kernels.drift`, less what the true motion may stray. A zone turns with LVLH: its
centre and blocks are taken at the nodes, and between them they are within W (b - a)^2/8 times their size of a chord
(:mod:`safestart.missed_burn.earth.frame`).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from safestart.missed_burn.kernels.drift import ROUNDING
from safestart.missed_burn.kernels.nearest import nearest
from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled

_FIRST = 48
Ends = NDArray[np.int64]
Flags = NDArray[np.bool_]


@compiled()
def images_of(tables: Floats, centre: Floats, columns: Floats, ends: Ends) -> tuple[Floats, Floats]:
    """Positions (T, 1 + C, 3) of the centre and the columns at all times, and sizes (T, 1 + K) of centre and blocks."""
    count, many = len(tables), len(columns)
    images, sizes = np.empty((count, 1 + many, 3)), np.empty((count, 1 + len(ends)))
    for t in range(count):
        image_at(tables[t], centre, columns, ends, images[t], sizes[t])
    return images, sizes


@compiled()
def image_at(rows: Floats, centre: Floats, columns: Floats, ends: Ends, image: Floats, sizes: Floats) -> None:
    """The same at one time: ``rows`` (3, 6); writes ``image`` (1 + C, 3) and ``sizes`` (1 + K,)."""
    for i in range(3):
        value = 0.0
        for j in range(6):
            value += rows[i, j] * centre[j]
        image[0, i] = value
        for c in range(len(columns)):
            value = 0.0
            for j in range(6):
                value += rows[i, j] * columns[c, j]
            image[1 + c, i] = value
    sizes[0] = math.sqrt(image[0, 0] ** 2 + image[0, 1] ** 2 + image[0, 2] ** 2)
    begin = 0
    for k in range(len(ends)):
        square = 0.0
        for c in range(begin, ends[k]):
            for i in range(3):
                square += image[1 + c, i] ** 2
        sizes[1 + k] = math.sqrt(square)
        begin = ends[k]


@compiled()
def _known(
    t: int,
    known: Flags,
    path: Floats,
    tables: Floats,
    centre: Floats,
    columns: Floats,
    ends: Ends,
    frames: Floats,
    offset: Floats,
    still: Floats,
    images: Floats,
    sizes: Floats,
) -> None:
    """Images and sizes of a node, of which few are ever looked at; the first size is that of the path. The zone's
    columns follow those of the set, its centre is taken off the set's."""
    if known[t]:
        return
    known[t] = True
    moving = len(columns)
    image_at(tables[t], centre, columns, ends, images[t, : 1 + moving], sizes[t, 1:])
    square = 0.0
    for i in range(3):
        square += path[t, i] ** 2
        images[t, 0, i] += path[t, i]
        for j in range(3):
            images[t, 0, i] += frames[t, j, i] * offset[j]
        for s in range(len(still)):
            value = 0.0
            for j in range(3):
                value += frames[t, j, i] * still[s, j]
            images[t, 1 + moving + s, i] = value
    sizes[t, 0] = math.sqrt(square)


@compiled()
def _value(images: Floats, ends: Ends, d: Floats) -> float:
    """f_d at one time; ``images`` (1 + C, 3)."""
    total = images[0, 0] * d[0] + images[0, 1] * d[1] + images[0, 2] * d[2]
    begin = 0
    for end in ends:
        square = 0.0
        for j in range(begin, end):
            part = images[1 + j, 0] * d[0] + images[1 + j, 1] * d[1] + images[1 + j, 2] * d[2]
            square += part * part
        total -= math.sqrt(square)
        begin = end
    return float(total)


@compiled()
def _bound(
    begin: int,
    end: int,
    d: Floats,
    images: Floats,
    sizes: Floats,
    ends: Ends,
    curve: float,
    turn: float,
    strays: Floats,
) -> float:
    """Lower bound between two nodes; ``curve``: K/8 times the square of the nodes' distance."""
    k = curve * (end - begin) ** 2
    if k >= 0.9:
        return -np.inf
    spread = 0.0
    for j in range(sizes.shape[1]):
        spread += max(sizes[begin, j], sizes[end, j])
    low: float = min(_value(images[begin], ends, d), _value(images[end], ends, d))
    low -= (k / (1.0 - k) + ROUNDING * 1e3) * spread + turn * (end - begin) ** 2 + strays[end - 1]
    return low


@compiled()
def least_between(
    path: Floats,
    tables: Floats,
    centre: Floats,
    columns: Floats,
    ends: Ends,
    curve: float,
    frames: Floats,
    offset: Floats,
    still: Floats,
    still_ends: Ends,
    turn: float,
    strays: Floats,
    enough: float,
    below: float,
    tolerance: float,
    most: int,
) -> tuple[float, float, int, Floats, Floats]:
    """Bounds on the least distance over all nodes of ``path`` (T, 3) and ``tables`` (T, 3, 6), and between them.

    ``frames`` (T, 3, 3): LVLH axes as rows; ``offset`` (3,), ``still`` (S, 3), ``still_ends``: the zone's centre,
    negative, and its blocks in LVLH; ``turn``: W/8 times the square of the nodes' distance times the zone's size, m.
    ``strays`` (T - 1,): how far the true motion may be from the linear one up to the end of each step; not decreasing.
    Ends as :func:`safestart.missed_burn.kernels.drift.least_distance` does. Returns the lower bound, the least
    distance of a member, its node and coordinates (C + S,), and the cells (N, 5): two nodes and a direction.
    """
    both = len(columns) + len(still)
    all_ends = np.concatenate((ends, still_ends + len(columns)))
    images, sizes = np.empty((len(tables), 1 + both, 3)), np.empty((len(tables), 2 + len(ends)))
    known = np.zeros(len(tables), dtype=np.bool_)
    last = len(tables) - 1
    cells, bounds = np.empty((most, 5)), np.empty(most)
    sharp = np.zeros(most, dtype=np.bool_)
    d, member, best = np.empty(3), np.empty(both), np.zeros(both)
    origin, turned = np.empty(3), np.empty((len(still), 3))
    count = min(_FIRST, last)
    for k in range(count):
        cells[k, 0], cells[k, 1] = last * k // count, last * (k + 1) // count
    upper, goal, when, fresh = np.inf, np.inf, 0, 0
    while True:
        for k in range(fresh, count):
            middle = int(cells[k, 0] + cells[k, 1]) // 2
            for t in (int(cells[k, 0]), middle, int(cells[k, 1])):
                _known(t, known, path, tables, centre, columns, ends, frames, offset, still, images, sizes)
            size = math.sqrt((images[middle, 0] ** 2).sum())
            for i in range(3):
                cells[k, 2 + i] = images[middle, 0, i] / size if size > 0.0 else 1.0 if i == 0 else 0.0
            bounds[k] = _bound(
                int(cells[k, 0]), int(cells[k, 1]), cells[k, 2:], images, sizes, all_ends, curve, turn, strays
            )
            sharp[k] = False
        fresh = count
        worst = int(np.argmin(bounds[:count]))
        low = bounds[worst]
        if low >= enough or low >= goal - tolerance or upper < below:
            break
        begin, end = int(cells[worst, 0]), int(cells[worst, 1])
        middle = (begin + end) // 2
        if not sharp[worst]:
            sharp[worst] = True
            _known(middle, known, path, tables, centre, columns, ends, frames, offset, still, images, sizes)
            for i in range(3):
                origin[i] = path[middle, i]
                for j in range(3):
                    origin[i] += frames[middle, j, i] * offset[j]
            for s in range(len(still)):
                turned[s] = images[middle, 1 + len(columns) + s]
            distance = nearest(
                tables[middle], centre, origin, columns, turned, all_ends, cells[worst, 2:], d, member
            )
            if distance < upper:
                upper, when = distance, middle
                best[:] = member
            goal = min(goal, distance - strays[max(middle - 1, 0)])
            two = _bound(begin, end, d, images, sizes, all_ends, curve, turn, strays)
            if two > low:
                cells[worst, 2:] = d
                bounds[worst] = two
            continue
        if count >= most or end - begin < 2:
            break
        cells[count, 0], cells[count, 1] = middle, end
        cells[worst, 1] = middle
        _known(middle, known, path, tables, centre, columns, ends, frames, offset, still, images, sizes)
        # The whole interval's direction serves both halves until they are the worst.
        cells[count, 2:] = cells[worst, 2:]
        for k in (worst, count):
            bounds[k] = _bound(
                int(cells[k, 0]), int(cells[k, 1]), cells[k, 2:], images, sizes, all_ends, curve, turn, strays
            )
            sharp[k] = False
        count += 1
        fresh = count
    return low, upper, when, best, cells[:count].copy()

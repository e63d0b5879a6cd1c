"""The missed-burn proof of an approach's hops in plain NumPy, for a service that compiles nothing.

The sets and the inequality are those of ``missed_burn`` (docs/theory/hopping.md): for a unit vector d and q(t) =
Phi_p(t)' d, distance(t) >= f(t) = q . centre - sum_k |M_k' q|, and on [a, b]

    distance >= min(f(a), f(b)) - (b - a)^2/8 (hypot(P . c, Q . c) + sum_k hypot(|M_k' P|, |M_k' Q|)).

Every direction is sound. A fixed grid takes those to the centre; where that is not enough the grid is refined, with
directions from the nearest member. So a bound may lie below the compiled prover's, never above what is true.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.hopping.approach import Approach
from safestart.missed_burn.plan import Burn, Errors
from safestart.missed_burn.sets import StateSet, add_burn
from safestart.model.scenario import Floats

SLACK = 1e-6
"""Metres taken off every bound, for rounding."""
_UP = 1.0 + 1e-9
"""Times of burns are rounded sums of those of hops."""
_PER_ORBIT = 96
_WORST = 10
_PARTS = 8
_ROUNDS = 6
_STEPS = 30


@dataclass(frozen=True, slots=True)
class Bounds:
    """The least distance of a drift lies between ``least`` (proved) and ``nearest``, m, of a member of the set's
    enclosure, which is ``when`` s after the burn in the direction ``towards`` (3,) from the target. ``cells`` (N, 5):
    the intervals of the proof, begin, end and direction."""

    least: float
    nearest: float
    when: float
    towards: Floats
    cells: Floats


@dataclass(frozen=True, slots=True)
class _Set:
    """centre (6,) + sum_k M_k b_k; ``first``: where each block begins among the columns (C, 6)."""

    centre: Floats
    columns: Floats
    first: list[int]


def hop_bounds(plan: Approach, keep_out: float, horizon: float, errors: Errors) -> list[Bounds]:
    """Bounds on the drift after each hop's impulse, over ``horizon`` s and at least until the next one; CWH motion."""
    return [
        _bounds(plan.mean_motion, drifting, max(horizon, hop.time * _UP), keep_out, math.inf)
        for hop, drifting in zip(plan.hops, _after(plan, errors), strict=True)
    ]


def start_bounds(plan: Approach, keep_out: float, horizon: float, errors: Errors) -> Bounds:
    """Bound the drift from the start, without any impulse, as :func:`hop_bounds` does after each."""
    return _bounds(plan.mean_motion, _at_start(plan, errors), horizon, keep_out, math.inf)


def error_level(
    plan: Approach, keep_out: float, horizon: float, errors: Errors, accuracy: float = 5e-3
) -> float:
    """lambda: the largest multiple of ``errors`` for which the drift from the start and after every hop's impulse is
    proved to keep out, from below to a relative ``accuracy``, at most 100; 0 if none is."""
    n = plan.mean_motion

    def holds(scale: float) -> bool:
        scaled = errors.scaled(scale)
        horizons = [horizon, *(max(horizon, hop.time) for hop in plan.hops)]
        sets = [_at_start(plan, scaled), *_after(plan, scaled)]
        # The last hop is the nearest, and mostly the first to fail.
        pairs = reversed(list(zip(sets, horizons, strict=True)))
        return all(_bounds(n, one, length, keep_out, keep_out).least >= keep_out for one, length in pairs)

    most = 100.0
    if errors.thrust_share > 0.0:
        most = min(most, 0.99 / errors.thrust_share)
    if errors.thrust_angle > 0.0:
        most = min(most, 0.5 * math.pi / errors.thrust_angle)
    if holds(most):
        return most
    low, high = 0.0, most
    scale = min(1.0, most)
    if holds(scale):
        low = scale
        while 2.0 * low < most and holds(2.0 * low):
            low *= 2.0
        high = min(2.0 * low, most)
    else:
        high = scale
        while low == 0.0 and high > 1e-3:
            low, high = (0.5 * high, high) if holds(0.5 * high) else (0.0, 0.5 * high)
        if low == 0.0:
            return 0.0
    while high > low * (1.0 + accuracy):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def _at_start(plan: Approach, errors: Errors) -> _Set:
    return _made(_navigation(plan.states()[0], errors))


def _after(plan: Approach, errors: Errors) -> list[_Set]:
    """The set after each hop's impulse."""
    found = []
    for k, (before, impulse) in enumerate(zip(plan.states()[:-1], plan.impulses[:-1].tolist(), strict=True)):
        state = _navigation(before, errors)
        burn = Burn(0.0, (impulse[0], impulse[1], impulse[2]))
        add_burn(state, burn, k, 1.0 - errors.thrust_share, 1.0 + errors.thrust_share, errors.thrust_angle)
        found.append(_made(state))
    return found


def _navigation(before: Floats, errors: Errors) -> StateSet:
    state = StateSet(before)
    state.box(np.array([*errors.position, *errors.velocity]), "navigation")
    return state


def _made(state: StateSet) -> _Set:
    return _Set(
        state.centre, np.array(state.columns).reshape(-1, 6), [0, *state.ends[:-1]] if state.ends else []
    )


def _bounds(n: float, drifting: _Set, horizon: float, keep_out: float, enough: float) -> Bounds:
    """Bounds; done as soon as ``enough`` is proved, or a member lies within ``keep_out`` where that is all there is to
    know."""
    count = max(math.ceil(_PER_ORBIT * horizon * n / math.tau), 8)
    edges = np.linspace(0.0, horizon, count + 1)
    begin, end = edges[:-1], edges[1:]
    sides = _to_centre(n, drifting, begin, end)
    low, sharp = _proved(n, drifting, begin, end, sides), np.zeros(count, dtype=bool)
    near, when, side = math.inf, 0.0, np.array([1.0, 0.0, 0.0])
    for _ in range(_ROUNDS):
        if float(low.min()) - SLACK >= enough or sharp[int(np.argmin(low))]:
            break
        worst = np.argsort(low)[:_WORST]
        worst = worst[~sharp[worst]]
        a, b = _cut(begin[worst], end[worst])
        middle = 0.5 * (a + b)
        towards, found = _nearest(n, drifting, middle)
        k = int(np.argmin(found))
        if found[k] < near:
            near, when, side = float(found[k]), float(middle[k]), towards[k]
        keep = np.ones(len(low), dtype=bool)
        keep[worst] = False
        begin, end = np.concatenate([begin[keep], a]), np.concatenate([end[keep], b])
        low = np.concatenate([low[keep], _proved(n, drifting, a, b, towards)])
        sides = np.concatenate([sides[keep], towards])
        sharp = np.concatenate([sharp[keep], np.ones(len(a), dtype=bool)])
        if math.isfinite(enough) and near < keep_out:
            break
    cells = np.column_stack([begin, end, sides])
    return Bounds(max(float(low.min()) - SLACK, 0.0), near, when, side, cells)


def _cut(begin: Floats, end: Floats) -> tuple[Floats, Floats]:
    """Every interval in equal parts that leave nothing out."""
    edges = np.linspace(begin, end, _PARTS + 1)
    edges[0], edges[-1] = begin, end
    return edges[:-1].ravel(), edges[1:].ravel()


def position_rows(n: float, times: Floats) -> Floats:
    """Position rows (T, 3, 6) of the CWH transition; 1 - cos loses at most 1e-16 / n m per m/s, far below ``SLACK``."""
    phase = n * times
    s, c = np.sin(phase), np.cos(phase)
    rows = np.zeros((len(times), 3, 6))
    rows[:, 0, 0], rows[:, 0, 3], rows[:, 0, 4] = 4.0 - 3.0 * c, s / n, 2.0 * (1.0 - c) / n
    rows[:, 1, 0], rows[:, 1, 1] = 6.0 * (s - phase), 1.0
    rows[:, 1, 3], rows[:, 1, 4] = -2.0 * (1.0 - c) / n, (4.0 * s - 3.0 * phase) / n
    rows[:, 2, 2], rows[:, 2, 5] = c, s / n
    return rows


def _block_norm(values: Floats, first: list[int]) -> Floats:
    """Sum over blocks of the norm of each block's entries; ``values`` (..., C)."""
    if not first:
        return np.zeros(values.shape[:-1])
    total: Floats = np.sqrt(np.add.reduceat(values**2, first, axis=-1)).sum(axis=-1)
    return total


def _to_centre(n: float, drifting: _Set, begin: Floats, end: Floats) -> Floats:
    """Directions (K, 3) from the target to the centre in the middle of the intervals."""
    middle = position_rows(n, 0.5 * (begin + end)) @ drifting.centre
    size = np.linalg.norm(middle, axis=1, keepdims=True)
    towards: Floats = np.where(size > 0.0, middle / np.maximum(size, 1e-300), [1.0, 0.0, 0.0])
    return towards


def _proved(n: float, drifting: _Set, begin: Floats, end: Floats, towards: Floats) -> Floats:
    """Lower bounds (K,) on the distance over the intervals, in the directions ``towards`` (K, 3)."""
    at_begin, at_end = position_rows(n, begin), position_rows(n, end)
    ends = []
    for rows in (at_begin, at_end):
        q = np.einsum("kij,ki->kj", rows, towards)
        ends.append(q @ drifting.centre - _block_norm(q @ drifting.columns.T, drifting.first))
    cosine, sine = _bends(n, towards)
    bend = np.hypot(cosine @ drifting.centre, sine @ drifting.centre)
    if drifting.first:
        square = (cosine @ drifting.columns.T) ** 2 + (sine @ drifting.columns.T) ** 2
        bend += np.sqrt(np.add.reduceat(square, drifting.first, axis=1)).sum(axis=1)
    low: Floats = np.minimum(*ends) - (end - begin) ** 2 / 8.0 * bend
    return low


def _bends(n: float, d: Floats) -> tuple[Floats, Floats]:
    """P and Q (K, 6) of q'' = P cos n t + Q sin n t, from the second derivatives of the CWH transition."""
    cosine, sine = np.zeros((len(d), 6)), np.zeros((len(d), 6))
    x, y, z = d[:, 0], d[:, 1], d[:, 2]
    cosine[:, 0], sine[:, 0] = 3.0 * n * n * x, -6.0 * n * n * y
    cosine[:, 2] = -n * n * z
    cosine[:, 3], sine[:, 3] = -2.0 * n * y, -n * x
    cosine[:, 4], sine[:, 4] = 2.0 * n * x, -4.0 * n * y
    sine[:, 5] = -n * z
    return cosine, sine


def _nearest(n: float, drifting: _Set, times: Floats) -> tuple[Floats, Floats]:
    """Members near the target at ``times`` (K,): directions (K, 3) to them and distances (K,).

    Accelerated projected gradients on |centre + G b|^2 over the blocks' unit balls (Beck and Teboulle 2009).
    """
    rows = position_rows(n, times)
    centre = rows @ drifting.centre
    gather = rows @ drifting.columns.T
    size = np.maximum((gather**2).sum(axis=(1, 2)), 1e-300)
    b = np.zeros((len(times), len(drifting.columns)))
    ahead, weight = b, 1.0
    lengths = np.diff([*drifting.first, b.shape[1]])
    for _ in range(_STEPS if drifting.first else 0):
        position = centre + (gather @ ahead[..., None])[..., 0]
        moved = ahead - (position[:, None] @ gather)[:, 0] / size[:, None]
        norms = np.sqrt(np.add.reduceat(moved**2, drifting.first, axis=1))
        moved /= np.repeat(np.maximum(norms, 1.0), lengths, axis=1)
        heavier = 0.5 * (1.0 + math.sqrt(1.0 + 4.0 * weight * weight))
        ahead = moved + (weight - 1.0) / heavier * (moved - b)
        b, weight = moved, heavier
    position = centre + (gather @ b[..., None])[..., 0]
    distance = np.linalg.norm(position, axis=1)
    towards = position / np.maximum(distance, 1e-300)[:, None]
    towards[distance == 0.0] = [1.0, 0.0, 0.0]
    return towards, distance

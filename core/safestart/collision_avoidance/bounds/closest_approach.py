"""Where a free motion passes closest to the origin: closed form, everywhere, without a grid.

It has three uses: an adversary that pushes against the miss, a pilot that pushes with it, and a lower bound of the
game's value for states outside every lattice (Player 1 coasts, Player 2 pushes as hard as it can).
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from safestart.collision_avoidance.game import Game
from safestart.model.scenario import Floats

TIMES = 120
_ROUNDING = 1e-9
"""Rounding allowance relative to the size of a state: a position needs less than a hundredth of it."""


class Miss(NamedTuple):
    """``vector`` (N, m): position at the closest approach, m; ``time`` (N,) in s. ``slope`` (N, 2 m): gradient of its
    length by the state; ``bound`` (N,): lower bound of the game's value, m."""

    vector: Floats
    time: Floats
    slope: Floats
    bound: Floats


class _Tables(NamedTuple):
    """``times`` (J,); ``rows`` (J, 2 m, 2 m) of the free motion; ``reach`` (J,): how far the disturbance can push the
    position by then; ``sag`` (2,): a path's deviation from its chord, per speed and per distance at its start."""

    times: Floats
    rows: Floats
    reach: Floats
    sag: tuple[float, float]


@lru_cache(maxsize=8)
def _tables(game: Game, horizon: float) -> _Tables:
    m, w, step = game.channels, game.mean_motion, horizon / TIMES
    times = np.linspace(0.0, horizon, TIMES + 1)
    transitions = np.array([game.transition(float(tau)) for tau in times])
    pushes = np.linalg.norm(transitions[:, :m, m:], ord=2, axis=(1, 2))
    # Between samples the norm of M exceeds the larger end by at most h^2 / 8 max |M''|, |M''| <= 6 w.
    larger = np.maximum(pushes[1:], pushes[:-1]) + 0.125 * step * step * 6.0 * w
    reach = np.concatenate([[0.0], np.cumsum(larger * np.diff(times))]) * game.disturbance.radius
    # |p''| <= 2 w |v| + 3 w^2 |p|, both at most their values at the start plus the step's increase.
    grown = 1.0 - 2.0 * w * step - 3.0 * (w * step) ** 2
    share = 0.125 * step * step / grown if grown > 0.0 else np.inf
    return _Tables(times, transitions, reach, (share * (2.0 * w + 3.0 * w * w * step), share * 3.0 * w * w))


def closest(game: Game, states: Floats, to_go: float, horizon: float) -> Miss:
    """Closest approach of states (N, 2 m) within ``to_go`` seconds, at most ``horizon``, to one 120th of it.

    ``bound`` is the least distance of the chords between samples, minus the path's deviation from them and the
    disturbance's effect until their ends; it holds at all times.
    """
    tables, m = _tables(game, horizon), game.channels
    count = max(1, int(np.searchsorted(tables.times, to_go + 1e-9)))
    # The last chord may end after the time to go, which can only lower the bound.
    ends = min(count + 1, len(tables.times)) if tables.times[count - 1] < to_go else count
    flown = np.einsum("jik,nk->nji", tables.rows[:ends], states)
    positions = flown[:, :count, :m]
    distances = np.linalg.norm(positions, axis=2)
    first = distances.argmin(axis=1)
    every = np.arange(len(states))
    vector = positions[every, first]
    length = np.maximum(distances[every, first], 1e-9)
    slope = np.einsum("ni,nik->nk", vector / length[:, None], tables.rows[first, :m])
    return Miss(vector, tables.times[first], slope, _bound(flown, tables, m) - game.keep_out_m)


def _bound(flown: Floats, tables: _Tables, m: int) -> Floats:
    """Distance (N,) that free motions (N, J, 2 m) keep at all times against every disturbance."""
    p, v = flown[:, :, :m], flown[:, :, m:]
    least = np.linalg.norm(p[:, 0], axis=1)
    if flown.shape[1] > 1:
        distance, speed = np.linalg.norm(p[:, :-1], axis=2), np.linalg.norm(v[:, :-1], axis=2)
        sag = tables.sag[0] * speed + tables.sag[1] * distance
        chords = segment_distance(p[:, :-1], p[:, 1:])
        least = np.minimum(least, (chords - sag - tables.reach[1 : flown.shape[1]]).min(axis=1))
    out: Floats = least - _ROUNDING * np.abs(flown[:, 0]).max(axis=1)
    return out


def segment_distance(before: Floats, after: Floats) -> Floats:
    """Distance (...) of the segments between positions (..., m) from the origin."""
    way = after - before
    length = np.maximum((way * way).sum(axis=-1), 1e-300)
    share = np.clip(-(way * before).sum(axis=-1) / length, 0.0, 1.0)
    return np.asarray(np.linalg.norm(before + share[..., None] * way, axis=-1))

"""Where a free motion passes closest to the origin: closed form, everywhere, without a grid.

It serves three times: an adversary that pushes against the miss, a pilot that pushes with it, and a lower bound of the
game's value for states that no lattice covers (Player 1 coasts, Player 2 pushes all it can).
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from safestart.collision_avoidance.game import Game
from safestart.model.scenario import Floats

TIMES = 120


class Miss(NamedTuple):
    """``vector`` (N, m): position at the closest approach, m; ``time`` (N,) in s; ``slope`` (N, 2 m): what changes
    its length, by state; ``bound`` (N,): no more than the game's value, m."""

    vector: Floats
    time: Floats
    slope: Floats
    bound: Floats


@lru_cache(maxsize=8)
def _tables(game: Game, horizon: float) -> tuple[Floats, Floats, Floats]:
    """Times (J,), rows (J, m, 2 m) of the position, and how far the disturbance can push it by then (J,)."""
    m = game.channels
    times = np.linspace(0.0, horizon, TIMES + 1)
    transitions = np.array([game.transition(float(tau)) for tau in times])
    # A chord of the interval's ends lies above a convex function; the norm of M is one to within its rounding here.
    pushes = np.linalg.norm(transitions[:, :m, m:], ord=2, axis=(1, 2))
    reach = np.concatenate([[0.0], np.cumsum(np.maximum(pushes[1:], pushes[:-1]) * np.diff(times))])
    return times, transitions[:, :m], reach * game.disturbance.radius


def closest(game: Game, states: Floats, to_go: float, horizon: float) -> Miss:
    """Closest approach of states (N, 2 m) within ``to_go`` seconds, at most ``horizon``, to one 120th of it."""
    times, rows, reach = _tables(game, horizon)
    count = max(1, int(np.searchsorted(times, to_go + 1e-9)))
    flown = np.einsum("jik,nk->nji", rows[:count], states)
    distances = np.linalg.norm(flown, axis=2)
    first = distances.argmin(axis=1)
    every = np.arange(len(states))
    vector = flown[every, first]
    length = np.maximum(distances[every, first], 1e-9)
    slope = np.einsum("ni,nik->nk", vector / length[:, None], rows[first])
    bound = (distances - reach[:count]).min(axis=1) - game.keep_out_m
    return Miss(vector, times[first], slope, bound)

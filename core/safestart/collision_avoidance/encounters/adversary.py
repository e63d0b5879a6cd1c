"""Strategies of Player 2: the worst case by the value function or by mirroring the control, pursuit, chance, none."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from safestart.collision_avoidance.bounds.closest_approach import closest
from safestart.collision_avoidance.encounters.observation import Moment
from safestart.collision_avoidance.game import Game
from safestart.model.scenario import Floats

Adversary = Callable[[Moment, Floats], Floats]
"""d (N, m) at a moment, given Player 1's command (N, m)."""

ADVERSARIES = ("worst", "mirror", "pursuit", "random", "none")
TITLES = {
    "worst": "worst case (value function)",
    "mirror": "mirror (reads the control)",
    "pursuit": "pursuit of the miss",
    "random": "random, held",
    "none": "none",
}


def adversary(name: str, game: Game, horizon_s: float, count: int, seed: int, hold_steps: int) -> Adversary:
    """The adversary of that name for ``count`` encounters.

    ``worst`` lowers the value as fast as it can; ``mirror`` answers u with -k u with the largest possible k, which
    keeps the sum in the set that certifies the unsafe states; ``pursuit`` pushes against the miss; ``random`` draws
    from its set's boundary directions and sizes, held for ``hold_steps`` steps.
    """
    zero = np.zeros((count, game.channels))
    if name == "worst":
        return lambda moment, _: game.disturbance.extreme(-moment.gradient[:, game.channels :])
    if name == "mirror":
        shares = _shares(game)
        return lambda _, command: -shares * command
    if name == "pursuit":
        return lambda moment, _: game.disturbance.extreme(
            -closest(game, moment.states, moment.to_go, horizon_s).vector
        )
    if name == "random":
        return _Random(game, zero, np.random.default_rng(seed), hold_steps)
    return lambda _, __: zero


def until(opponent: Adversary, step: int) -> Adversary:
    """The same adversary up to a step, and none afterwards."""
    return lambda moment, command: opponent(moment, command) if moment.step < step else np.zeros_like(command)


def _shares(game: Game) -> Floats:
    """The share k (m,) of each channel of u that Player 2 can cancel."""
    found = np.zeros(game.channels)
    for own, left in zip(game.control.parts, game.enforceable.parts, strict=True):
        found[own.begin : own.end] = 1.0 - left.radius / own.radius if own.radius > 0.0 else 0.0
    return found


class _Random:
    """A push held for some steps, then drawn again: any direction, any size up to the bound."""

    def __init__(self, game: Game, zero: Floats, rng: np.random.Generator, hold_steps: int) -> None:
        self._game, self._held, self._rng, self._hold = game, zero, rng, hold_steps

    def __call__(self, moment: Moment, command: Floats) -> Floats:
        del command
        if moment.step % self._hold == 0:
            shape = self._held.shape
            ends = self._game.disturbance.extreme(self._rng.normal(size=shape))
            self._held = ends * self._rng.random((shape[0], 1))
        return self._held

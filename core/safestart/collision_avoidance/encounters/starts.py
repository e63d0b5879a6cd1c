"""Starts of encounters: just outside the unsafe set, inside it, or on the way to it.

The search uses the game's axes; the results are in LVLH.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from safestart.collision_avoidance.bounds.certified import unavoidable
from safestart.collision_avoidance.bounds.closest_approach import closest
from safestart.collision_avoidance.encounters.observation import Observer
from safestart.collision_avoidance.tube import Answer
from safestart.errors import invalid
from safestart.model.scenario import Bools, Floats
from safestart.runtime.progress import Context

BATCH, BATCHES = 20_000, 200
"""States per draw, and the largest number of draws."""

Accept = Callable[[Floats], Bools]


def near_boundary(observer: Observer, count: int, band_m: float, seed: int, context: Context) -> Floats:
    """``count`` starts (count, 6), LVLH, uniform in the lattice's box, accepted if hard but not lost.

    Conditions: 0 < value <= band; the free motion (nobody thrusts) comes within the keep-out distance inside the
    horizon, so that Player 1 must act; the tube's answer is outside the unsafe set (proved safe, or a value above the
    grid error). Raises ``InvalidInput`` if it finds too few.
    """
    tube = observer.tube

    def accept(states: Floats) -> Bools:
        value = observer.look(0, states, tube.horizon_s).value
        kept: Bools = (value > 0.0) & (value <= band_m)
        kept[kept] = _coasting_lost(observer, states[kept])
        if kept.any():
            kept[kept] = tube.answer(states[kept]) >= Answer.SAFE
        return kept

    return _draw(observer, count, accept, seed, "starts near the boundary", context)


def certified_unsafe(observer: Observer, count: int, seed: int, context: Context) -> Floats:
    """``count`` starts (count, 6) outside the keep-out distance, proved lost whatever Player 1 does.

    Uniform in the lattice's box among those; raises as :func:`near_boundary`.
    """

    def accept(states: Floats) -> Bools:
        kept: Bools = _coasting_lost(observer, states)
        kept[kept] = unavoidable(observer.game, states[kept], observer.tube.horizon_s)
        return kept

    return _draw(observer, count, accept, seed, "certified unsafe starts", context)


def approaching(
    observer: Observer,
    radius_m: float,
    speed_m_s: float,
    count: int,
    level_m: float,
    seed: int,
    context: Context,
) -> Floats:
    """``count`` planar starts (count, 6) of a supervised flight: uniform in a disk of ``radius_m``.

    At a speed up to ``speed_m_s``, aimed to pass within two keep-out distances; the value is above ``level_m``.
    Raises as :func:`near_boundary`.
    """
    keep_out = observer.game.keep_out_m
    rng = np.random.default_rng(seed)

    def draw(size: int) -> Floats:
        radius = radius_m * np.sqrt(rng.random(size))
        angle, turn = rng.uniform(-np.pi, np.pi, size), rng.uniform(-1.0, 1.0, size)
        speed = rng.random(size) * speed_m_s
        heading = angle + np.pi + turn * np.arcsin(np.minimum(2.0 * keep_out / np.maximum(radius, 1e-9), 1.0))
        place = radius * np.array([np.cos(angle), np.sin(angle)])
        return np.concatenate([place, speed * np.array([np.cos(heading), np.sin(heading)])]).T

    def accept(states: Floats) -> Bools:
        outside: Bools = np.linalg.norm(states[:, :2], axis=1) > keep_out
        return outside & (observer.look(0, states, observer.tube.horizon_s).value > level_m)

    return observer.game.to_lvlh(_collect(draw, accept, count, "approaching starts", context))


def _coasting_lost(observer: Observer, states: Floats) -> Bools:
    """True if outside the keep-out distance and the free motion comes inside within the horizon, (N,)."""
    game, horizon = observer.game, observer.tube.horizon_s
    lost: Bools = np.linalg.norm(states[:, : game.channels], axis=1) > game.keep_out_m
    near = closest(game, states[lost], horizon, horizon)
    lost[lost] = np.linalg.norm(near.vector, axis=1) <= game.keep_out_m
    return lost


def _draw(observer: Observer, count: int, accept: Accept, seed: int, what: str, context: Context) -> Floats:
    rng = np.random.default_rng(seed)
    lattice = observer.tube.lattice

    def draw(size: int) -> Floats:
        return rng.uniform(lattice.low, lattice.high, size=(size, lattice.ndim))

    return observer.game.to_lvlh(_collect(draw, accept, count, what, context))


def _collect(
    draw: Callable[[int], Floats], accept: Accept, count: int, what: str, context: Context
) -> Floats:
    found: list[Floats] = []
    have = 0
    for batch in range(BATCHES):
        context.step(min(have, count), count, what)
        states = draw(BATCH)
        kept = states[accept(states)]
        found.append(kept)
        have += len(kept)
        if have >= count:
            return np.concatenate(found)[:count]
        if batch >= 9 and have * (BATCHES / (batch + 1)) < 0.5 * count:
            break
    raise invalid("encounters", f"at most {have}: no more {what} were found in the lattice's box", count)

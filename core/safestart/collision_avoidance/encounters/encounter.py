"""Closed-loop encounters: N flights at once, exact between samples, and the least separation at all times.

It is the loop of :mod:`safestart.simulation.loop` for many flights in step, with the other player's push. No flight
ends at a violation, as the separation is the result. Inside, states are in the game's axes.
"""

from __future__ import annotations

import numpy as np

from safestart.collision_avoidance.bounds.closest_approach import segment_distance
from safestart.collision_avoidance.encounters.adversary import Adversary
from safestart.collision_avoidance.encounters.clock import Clock
from safestart.collision_avoidance.encounters.observation import Observer
from safestart.control.controller import Controller
from safestart.errors import invalid
from safestart.model.scenario import Bools, Floats
from safestart.runtime.progress import Context
from safestart.simulation.record import Path, Record


def lost(flown: Record, distance_m: float) -> Bools:
    """Which encounters came within ``distance_m``, (N,)."""
    return np.asarray(flown.margin <= distance_m)


def fly(
    observer: Observer,
    starts: Floats,
    pilot: Controller,
    opponent: Adversary,
    clock: Clock,
    context: Context | None = None,
    *,
    keep_paths: bool = False,
) -> Record:
    """Fly ``starts`` (N, 6), LVLH. Raises ``InvalidInput`` for another shape and ``Cancelled`` between steps.

    ``margin`` (N,) of the record is the separation: a lower bound, m, of the true distance at all times. Between
    samples a path deviates from its chord by at most h^2 / 8 of its acceleration, which is subtracted. ``delta_v`` adds
    up the channels of a box, or the length for a disk. The pilot commands all flights at once.
    """
    game, m = observer.game, observer.game.channels
    if starts.ndim != 2 or starts.shape[1] != 6:
        raise invalid("starts", "an array of shape (N, 6)", starts.shape)
    context = context or Context()
    phi, gamma = game.transition(clock.period_s), game.held_input(clock.period_s)
    matrix = game.matrix()[m:]
    pilot.begin(starts)
    states = game.from_lvlh(np.asarray(starts, dtype=np.float64))
    least = np.linalg.norm(states[:, :m], axis=1)
    spent, peak = np.zeros(len(states)), np.zeros(len(states))
    path, held = [game.to_lvlh(states)], []
    horizon = observer.tube.horizon_s
    for step in range(clock.steps):
        context.step(step, clock.steps, "periods")
        moment = observer.look(step, states, clock.to_go(step, horizon))
        thrust = pilot.command(step, game.to_lvlh(states)).thrust
        u = game.thrust_from_lvlh(thrust)
        total = u + opponent(moment, u)
        after = states @ phi.T + total @ gamma.T
        # The acceleration changes little within a period: its larger end plus a tenth bounds it.
        ends = [np.linalg.norm(x @ matrix.T + total, axis=1) for x in (states, after)]
        sag = 1.1 * np.maximum(*ends) * clock.period_s**2 / 8.0
        least = np.minimum(least, np.maximum(segment_distance(states[:, :m], after[:, :m]) - sag, 0.0))
        for part in game.control.parts:
            spent += np.linalg.norm(u[:, part.begin : part.end], axis=1) * clock.period_s
        peak = np.maximum(peak, np.linalg.norm(u, axis=1))
        states = after
        if keep_paths:
            path.append(game.to_lvlh(states))
            held.append(thrust)
    count = len(states)
    return Record(
        least,
        np.full(count, np.inf),
        spent,
        peak,
        np.full(count, clock.steps),
        np.zeros(count, np.int64),
        _paths(clock, np.array(path), np.array(held)) if keep_paths else (),
    )


def _paths(clock: Clock, states: Floats, thrust: Floats) -> tuple[Path, ...]:
    """The paths of states (K + 1, N, 6) and thrust (K, N, 3), as views."""
    times: Floats = clock.period_s * np.arange(len(states), dtype=np.float64)
    return tuple(Path(times, states[:, n], thrust[:, n]) for n in range(states.shape[1]))

"""Closed-loop encounters: N flights at once, exact between samples, and the least separation at all times."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.collision_avoidance.encounters.adversary import Adversary
from safestart.collision_avoidance.encounters.observation import Sight
from safestart.collision_avoidance.encounters.pilots import Pilot
from safestart.errors import invalid
from safestart.model.scenario import Bools, Floats
from safestart.runtime.progress import Context


@dataclass(frozen=True, slots=True)
class Clock:
    """``duration_s`` in steps of one control period of ``period_s``; commands and pushes are held for a period.

    ``receding`` keeps the whole horizon ahead at every step (a supervisor on watch); otherwise the game ends with the
    horizon and the time to go runs down (the game that the value function is about).
    """

    period_s: float
    duration_s: float
    receding: bool = False

    def __post_init__(self) -> None:
        if not 0.0 < self.period_s <= self.duration_s < math.inf:
            raise invalid("period_s", "0 < period_s <= duration_s", (self.period_s, self.duration_s))

    @property
    def steps(self) -> int:
        """Whole periods."""
        return math.floor(self.duration_s / self.period_s + 1e-9)


@dataclass(frozen=True, slots=True)
class Flights:
    """Result of N encounters.

    ``separation_m`` (N,): the least distance, no larger than the true one at any time, sampled or between;
    ``delta_v_m_s`` (N,): channels of a box add up, of a disk its size counts; ``states`` (N, 2 m) at the end;
    ``path`` (K + 1, N, 2 m) when asked for.
    """

    separation_m: Floats
    delta_v_m_s: Floats
    states: Floats
    path: Floats | None

    def lost(self, distance_m: float) -> Bools:
        """Which came within ``distance_m``, (N,)."""
        return np.asarray(self.separation_m <= distance_m)


def fly(
    sight: Sight,
    starts: Floats,
    pilot: Pilot,
    opponent: Adversary,
    clock: Clock,
    context: Context | None = None,
    *,
    keep_path: bool = False,
) -> Flights:
    """Fly ``starts`` (N, 2 m). Raises ``InvalidInput`` for another shape and ``Cancelled`` between steps.

    Between samples a path leaves its chord by no more than h^2 / 8 of its acceleration, which is subtracted.
    """
    game, m = sight.game, sight.game.channels
    if starts.ndim != 2 or starts.shape[1] != 2 * m:
        raise invalid("starts", f"an array of shape (N, {2 * m})", starts.shape)
    context = context or Context()
    phi, gamma = game.transition(clock.period_s), game.held_input(clock.period_s)
    matrix = game.matrix()[m:]
    states = np.array(starts, dtype=np.float64)
    least = np.linalg.norm(states[:, :m], axis=1)
    spent = np.zeros(len(states))
    path = [states]
    horizon = sight.tube.horizon_s
    for step in range(clock.steps):
        context.step(step, clock.steps, "periods")
        to_go = horizon if clock.receding else max(horizon - step * clock.period_s, 0.0)
        moment = sight.look(step, states, to_go)
        u = pilot(moment)
        total = u + opponent(moment, u)
        after = states @ phi.T + total @ gamma.T
        # The acceleration changes little within a period: its larger end and a tenth stand for all of it.
        ends = [np.linalg.norm(x @ matrix.T + total, axis=1) for x in (states, after)]
        sag = 1.1 * np.maximum(*ends) * clock.period_s**2 / 8.0
        least = np.minimum(least, np.maximum(_chord(states[:, :m], after[:, :m]) - sag, 0.0))
        for part in game.control.parts:
            spent += np.linalg.norm(u[:, part.begin : part.end], axis=1) * clock.period_s
        states = after
        if keep_path:
            path.append(states)
    return Flights(least, spent, states, np.array(path) if keep_path else None)


def _chord(before: Floats, after: Floats) -> Floats:
    """Distance (N,) of the segments between positions (N, m) from the origin."""
    way = after - before
    length = np.maximum((way * way).sum(axis=1), 1e-300)
    share = np.clip(-(way * before).sum(axis=1) / length, 0.0, 1.0)
    return np.asarray(np.linalg.norm(before + share[:, None] * way, axis=1))

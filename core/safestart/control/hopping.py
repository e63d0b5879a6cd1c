"""The hopping controller of paper 004: guidance re-times each hop from the estimate, an MPC plans all that remain."""

from __future__ import annotations

import numpy as np

from safestart.control.controller import Command
from safestart.errors import invalid
from safestart.hopping.approach import departure, line
from safestart.hopping.barrier import Barrier
from safestart.hopping.compiled_program import CompiledProgram
from safestart.hopping.hop_program import Solved, Weights
from safestart.hopping.hop_time_kernel import compiled_hop_phases
from safestart.model.scenario import Floats

_MOST_ROUNDS = 10
_ENOUGH = 1e-5
_HOLDS = 1e-3
"""A row holds within so many metres."""


class Hopping:
    """Impulses at the ends of hops, in LVLH.

    ``distances`` (hops + 1,): those of Algorithm 1. ``command(k, state)`` is asked at the start of hop k, and once more
    at the end of the last one, to stop; :meth:`wait` then says how long the hop lasts.
    """

    def __init__(
        self,
        mean_motion: float,
        angle_deg: float,
        distances: Floats,
        *,
        weights: Weights | None = None,
        barrier: Barrier | None = None,
        minimum_impulse: float = 0.0,
        phase: float | None = None,
    ) -> None:
        """``phase``: length of every hop, rad, instead of the hop-time equation's (paper 004, section 5.4)."""
        if len(distances) < 2 or not (np.diff(distances) < 0.0).all():
            raise invalid("distances", "at least two, falling", distances)
        self.n, self.angle, self.distances = mean_motion, float(angle_deg), distances
        self.weights, self.barrier, self.phase = weights or Weights(), barrier, phase
        self.minimum_impulse = minimum_impulse
        along = line(self.angle)
        out = np.array([0.0, 0.0, 1.0])
        self.axes = np.array([along, np.cross(out, along), out])
        self._wait = 0.0

    def begin(self, state: Floats) -> None:
        """Nothing is remembered."""

    def wait(self) -> float:
        """Seconds from the last command to the next one."""
        return self._wait

    def command(self, k: int, state: Floats) -> Command:
        """The impulse at the start of hop ``k``; ``feasible`` is False where the true barrier's rows do not hold."""
        if not 0 <= k < len(self.distances):
            raise invalid("k", f"0 to {len(self.distances) - 1}: one command a hop, and one to stop", k)
        remaining = self.distances[k + 1 :]
        times = self._times(state, remaining)
        self._wait = float(times[0]) if len(times) else 0.0
        program = CompiledProgram(self.n, self.axes, remaining, times, state, self.weights)
        found = program.solve()
        if not found.solved:
            return Command(np.zeros(3), False, "unsolved", self._plain(k, state))
        impulse = self._given(found)
        if self.barrier is None:
            return Command(np.zeros(3), True, "hop", impulse)
        return self._guarded(k, program, state, impulse, self.barrier)

    def _times(self, state: Floats, remaining: Floats) -> Floats:
        """Re-timed from the estimate: the first hop starts where the chaser is believed to be."""
        if not len(remaining):
            return np.zeros(0)
        if self.phase is not None:
            return np.full(len(remaining), self.phase / self.n)
        begin = max(float(self.axes[0] @ state[:3]), 1.02 * float(remaining[0]))
        rho = remaining / np.concatenate([[begin], remaining[:-1]])
        phases = compiled_hop_phases(np.full(len(rho), self.angle), np.minimum(rho, 0.98))
        if np.isnan(phases).any():
            raise invalid("angle_deg", "an angle with a hop for every share that is left", self.angle)
        return phases / self.n

    def _given(self, found: Solved) -> Floats:
        """The first impulse as the thrusters give it: components below the minimum impulse are left out."""
        first = found.impulses[0]
        given: Floats = np.where(np.abs(first) < self.minimum_impulse, 0.0, first)
        return given

    def _guarded(
        self, k: int, program: CompiledProgram, state: Floats, impulse: Floats, barrier: Barrier
    ) -> Command:
        """The impulse itself where its drift keeps out; else the best of two searches.

        The first begins at the impulse. Where it finds none, its drift passes the target on both sides of it, and
        linearised rows contradict each other; the second begins at the guidance's own hop, whose drift closes.
        """
        values, _ = barrier.rows(state, impulse)
        if float(values.min()) >= 0.0:
            return Command(np.zeros(3), True, "hop", impulse)
        best, value = self._searched(program, state, impulse, barrier)
        if value < -_HOLDS:
            other, other_value = self._searched(program, state, self._own_hop(k, state), barrier)
            if other_value > value:
                best, value = other, other_value
        return Command(np.zeros(3), value >= -_HOLDS, "barrier", best)

    def _searched(
        self, program: CompiledProgram, state: Floats, impulse: Floats, barrier: Barrier
    ) -> tuple[Floats, float]:
        """Rounds of linearised rows until the true ones hold and the impulse rests: the impulse, its least row."""
        values, slopes = barrier.rows(state, impulse)
        best, best_value = impulse, float(values.min())
        region = max(0.2 * float(np.abs(impulse).max()), 0.02)
        for _ in range(_MOST_ROUNDS):
            which = barrier.worst(values)
            lean, level = slopes[which], values[which] - slopes[which] @ impulse
            found = program.solve((lean, level), (impulse, region))
            if not found.solved:
                break
            after = self._given(found)
            moved, impulse = float(np.abs(after - impulse).max()), after
            # The minimum impulse is in: what is looked at again is what will be given.
            values, slopes = barrier.rows(state, impulse)
            least = float(values.min())
            if least >= min(best_value, -_HOLDS):
                best, best_value = impulse, least
            # It goes on past its first admissible point, to one that costs less.
            if moved < _ENOUGH:
                break
            region *= 0.8
        return best, best_value

    def _own_hop(self, k: int, state: Floats) -> Floats:
        """Impulse of the guidance's hop in the hop-time equation's own time; a stop after the last hop."""
        if k + 1 >= len(self.distances):
            return -state[3:]
        end = float(self.distances[k + 1])
        rho = min(end / max(float(self.axes[0] @ state[:3]), 1.02 * end), 0.98)
        time = float(compiled_hop_phases(np.array([self.angle]), np.array([rho]))[0]) / self.n
        if np.isnan(time):
            return self._plain(k, state)
        return departure(self.n, time, state[:3], end * self.axes[0]) - state[3:]

    def _plain(self, k: int, state: Floats) -> Floats:
        """Without a solution: the guidance's own impulse to the end of the hop, or a stop."""
        if k + 1 >= len(self.distances):
            return -state[3:]
        aim = departure(self.n, self._wait, state[:3], self.distances[k + 1] * self.axes[0])
        return aim - state[3:]

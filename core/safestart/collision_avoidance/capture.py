"""Capture set of the recovery box under the saturated PD law (paper 001, eqs. 8, 9, 16, 19, Figs. 3 and 4).

The law is a function of the state and leaves no decisions, so a simulated flight, without a grid, shows whether a state
reaches the box within the horizon. The paper's level set is here too, for comparison.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.collision_avoidance.capture_kernel import arrivals
from safestart.collision_avoidance.encounters.slot import Slot
from safestart.collision_avoidance.game import Game
from safestart.control.pd import PdGains, pd_thrust
from safestart.errors import invalid
from safestart.levelset import Ball, Box, Lattice, Options, Solution, solve
from safestart.levelset.dynamics import Aim, Rates
from safestart.model.scenario import Floats
from safestart.runtime.progress import Context

STEP = 0.5
"""Seconds between two checks of a flight; the law's fastest time constant is tens of seconds."""

# Speeds count as distances covered in this many seconds, so that the level set is equally steep along every axis.
_TIME = 100.0


def arrival_times(game: Game, slot: Slot, gains: PdGains, states: Floats, horizon_s: float) -> Floats:
    """First time (...) in s at which states (..., 4) are in the slot's box; inf if not within the horizon.

    No disturbance acts. Raises ``InvalidInput`` for a game that is not planar.
    """
    if game.channels != 2:
        raise invalid("game", "a planar game", f"{game.channels} channels")
    flat = np.ascontiguousarray(states, dtype=np.float64).reshape(-1, 4)
    disk = len(game.control.parts) == 1
    limits = [part.radius for part in game.control.parts]
    law = np.array(
        [game.mean_motion, *gains.position, *gains.speed, disk, limits[0], limits[-1], *slot.centre]
    )
    out = np.empty(len(flat))
    arrivals(flat, law, np.array(slot.half), STEP, horizon_s, out)
    return out.reshape(np.shape(states)[:-1])


@dataclass(frozen=True)
class ClosedLoop:
    """Motion for the level-set solver: eq. (5) with the PD law in the place of u, without inputs."""

    game: Game
    slot: Slot
    gains: PdGains
    varies: bool = False

    @property
    def bounds(self) -> list[tuple[Box | Ball, Aim, float]]:
        """No inputs."""
        return []

    def rates(self, lattice: Lattice, time: float) -> Rates:
        """Rates on the nodes."""
        del time
        axes = lattice.coordinates()
        a = self.game.matrix()
        drift = [[a[i, k] * axes[k] for k in range(4) if a[i, k] != 0.0] for i in range(4)]
        states = np.stack(np.broadcast_arrays(*axes), axis=-1)
        u = pd_thrust(states, np.array(self.slot.centre), self.gains, self.game.control)
        for channel in range(2):
            pushed = u[..., channel]
            # For a box every channel depends only on its own position and speed.
            if len(self.game.control.parts) == 2:
                pushed = pushed.take([0], axis=1 - channel).take([0], axis=3 - channel)
            drift[2 + channel].append(pushed)
        return Rates(drift, [])

    def gains_at(self, states: Floats, time: float) -> list[Floats]:
        """No inputs."""
        del states, time
        return []


def level_set(
    game: Game,
    slot: Slot,
    gains: PdGains,
    lattice: Lattice,
    horizon_s: float,
    options: Options,
    context: Context | None = None,
) -> Solution:
    """The capture set as a level set {V <= 0}: V is the least, over time, of the largest excess over the box.

    Speeds are weighted by 100 s. ``lattice`` should have a node in the middle of the box, or it may miss the box.
    """
    pairs = zip(lattice.coordinates(), slot.centre, slot.half, (1.0, 1.0, _TIME, _TIME), strict=True)
    excess = np.broadcast_arrays(*[(np.abs(x - c) - h) * scale for x, c, h, scale in pairs])
    values = np.max(np.stack(excess), axis=0)
    return solve(lattice, ClosedLoop(game, slot, gains), values, horizon_s, options=options, context=context)


@dataclass(frozen=True, slots=True)
class Agreement:
    """Numbers of nodes by flight and level set; the flight is the truth."""

    both: int
    flown_only: int
    level_set_only: int
    neither: int


def compare(solution: Solution, flown: Floats, states: Floats) -> Agreement | None:
    """Compare ``flown`` arrival times (N,) of ``states`` (N, 4) with a level set; None if the level set failed."""
    if solution.field is None:
        return None
    claimed, arrived = solution.field.value_at(states) <= 0.0, np.isfinite(flown)
    counts = [(claimed & arrived), (~claimed & arrived), (claimed & ~arrived), (~claimed & ~arrived)]
    return Agreement(*(int(mask.sum()) for mask in counts))

"""The avoid game in space: the value of the plane's game and of the normal motion's, whichever is larger.

The keep-out ball lies in the cylinder {|(x, y)| <= d, |z| <= d}, and motion normal to the plane is decoupled. Player 1
loses only if it is in the disk and in the slab at the same time; keeping out of either is enough: V >= max(V_plane,
V_normal). Two small grids, with 4 and 2 axes, replace one with 6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.collision_avoidance.bounds.certified import lower, upper
from safestart.collision_avoidance.game import Game
from safestart.collision_avoidance.tube import Answer, Tube
from safestart.errors import invalid
from safestart.model.scenario import Bools, Floats

_PLANE, _NORMAL = [0, 1, 3, 4], [2, 5]


@dataclass(frozen=True)
class SpaceTube:
    """A lower bound of the value of a game in space, states (..., 6) as (x, y, z, vx, vy, vz)."""

    game: Game
    plane: Tube
    normal: Tube

    @property
    def horizon_s(self) -> float:
        """Longest time to go."""
        return self.plane.horizon_s

    @property
    def grid_error_m(self) -> float:
        """Largest excess of :meth:`value` over the bound that it represents, as measured in both games."""
        return max(self.plane.grid_error_m, self.normal.grid_error_m)

    def covers(self, states: Floats) -> Bools:
        """Whether states lie in both lattices, (...)."""
        states = np.asarray(states, dtype=np.float64)
        return np.asarray(self.plane.covers(states[..., _PLANE]) & self.normal.covers(states[..., _NORMAL]))

    def value(self, states: Floats, time_to_go: float | None = None) -> Floats:
        """The larger value (...) of the two games; raises ``InvalidInput`` outside either lattice."""
        plane, normal = self._parts(states)
        return np.asarray(
            np.maximum(self.plane.value(plane, time_to_go), self.normal.value(normal, time_to_go))
        )

    def gradient(self, states: Floats, time_to_go: float | None = None) -> Floats:
        """Gradient (..., 6) of :meth:`value`, that of the game with the larger value."""
        plane, normal = self._parts(states)
        across = self.plane.value(plane, time_to_go) < self.normal.value(normal, time_to_go)
        found = np.zeros(np.shape(states))
        found[..., _PLANE] = np.where(across[..., None], 0.0, self.plane.gradient(plane, time_to_go))
        found[..., _NORMAL] = np.where(across[..., None], self.normal.gradient(normal, time_to_go), 0.0)
        return found

    def answer(self, states: Floats, time_to_go: float | None = None) -> Floats:
        """:class:`Answer` (...): first by the bounds of the game in space; the value can only add SAFE."""
        states = np.asarray(states, dtype=np.float64)
        time = self.horizon_s if time_to_go is None else time_to_go
        found = np.where(self.value(states, time) > self.grid_error_m, Answer.SAFE, Answer.UNDECIDED)
        safe = lower(self.game, states, max(time, 1e-9), goal_m=1e-6) > 0.0
        unsafe = upper(self.game, states, time) <= 0.0
        found = np.where(unsafe, Answer.PROVED_UNSAFE, np.where(safe, Answer.PROVED_SAFE, found))
        return np.asarray(found, dtype=np.int8)

    def _parts(self, states: Floats) -> tuple[Floats, Floats]:
        states = np.asarray(states, dtype=np.float64)
        if states.ndim == 0 or states.shape[-1] != 6:
            raise invalid("states", "last axis of length 6", states.shape)
        return states[..., _PLANE], states[..., _NORMAL]

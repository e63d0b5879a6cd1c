"""What both players know during an encounter: time, states, and the value function read at them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.collision_avoidance.bounds.closest_approach import closest
from safestart.collision_avoidance.game import Game
from safestart.collision_avoidance.tube import Tube
from safestart.model.scenario import Bools, Floats


@dataclass(frozen=True, slots=True)
class Moment:
    """Step ``step`` of N encounters: ``to_go`` seconds of the game are left.

    ``states`` (N, 2 m); ``value`` (N,) in m and ``gradient`` (N, 2 m) there; ``covered`` (N,): read off the lattice.
    """

    step: int
    to_go: float
    states: Floats
    value: Floats
    gradient: Floats
    covered: Bools

    def only(self, chosen: Bools) -> Moment:
        """The same of the chosen encounters."""
        return Moment(
            self.step,
            self.to_go,
            self.states[chosen],
            self.value[chosen],
            self.gradient[chosen],
            self.covered[chosen],
        )


@dataclass(frozen=True, slots=True)
class Sight:
    """Reads a tube at any state: beyond its lattice a closed form stands in, which is no more than the value."""

    game: Game
    tube: Tube

    def look(self, step: int, states: Floats, to_go: float) -> Moment:
        """The moment at states (N, 2 m) with ``to_go`` seconds left."""
        covered = self.tube.covers(states)
        value, gradient = np.empty(len(states)), np.empty(states.shape)
        if covered.any():
            value[covered], gradient[covered] = self.tube.read(states[covered], to_go)
        if not covered.all():
            beyond = closest(self.game, states[~covered], to_go, self.tube.horizon_s)
            value[~covered], gradient[~covered] = beyond.bound, beyond.slope
        return Moment(step, to_go, states, value, gradient, covered)

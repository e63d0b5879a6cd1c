"""The knowledge of both players during an encounter: time, states, and the value function there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from safestart.collision_avoidance.bounds.closest_approach import closest
from safestart.collision_avoidance.game import Game
from safestart.collision_avoidance.tube import Tube
from safestart.model.scenario import Bools, Floats


class Moment:
    """Step ``step`` of N encounters at ``states`` (N, 2 m), with ``to_go`` seconds of the game left.

    The value function is read at the first request, and only once.
    """

    def __init__(self, observer: Observer, step: int, to_go: float, states: Floats) -> None:
        self._observer, self.step, self.to_go, self.states = observer, step, to_go, states

    @cached_property
    def _reading(self) -> tuple[Floats, Floats]:
        return self._observer.read(self.states, self.to_go)

    @property
    def value(self) -> Floats:
        """The value (N,), m."""
        return self._reading[0]

    @property
    def gradient(self) -> Floats:
        """Gradient (N, 2 m) of the value."""
        return self._reading[1]

    def only(self, chosen: Bools) -> Moment:
        """What is observed in the chosen encounters alone."""
        some = Moment(self._observer, self.step, self.to_go, self.states[chosen])
        some.__dict__["_reading"] = self.value[chosen], self.gradient[chosen]
        return some


@dataclass(eq=False)
class Observer:
    """Reads a tube at any state; outside its lattice it uses a closed-form lower bound of the value."""

    game: Game
    tube: Tube
    _last: Moment | None = None

    def look(self, step: int, states: Floats, to_go: float) -> Moment:
        """The moment at states (N, 2 m) with ``to_go`` seconds left; repeated calls share one reading."""
        last = self._last
        if (
            last is None
            or (last.step, last.to_go) != (step, to_go)
            or not np.array_equal(last.states, states)
        ):
            self._last = last = Moment(self, step, to_go, states)
        return last

    def read(self, states: Floats, to_go: float) -> tuple[Floats, Floats]:
        """Value (N,) and gradient (N, 2 m) at states (N, 2 m)."""
        covered = self.tube.covers(states)
        value, gradient = np.empty(len(states)), np.empty(states.shape)
        if covered.any():
            value[covered], gradient[covered] = self.tube.read(states[covered], to_go)
        if not covered.all():
            beyond = closest(self.game, states[~covered], to_go, self.tube.horizon_s)
            value[~covered], gradient[~covered] = beyond.bound, beyond.slope
        return value, gradient

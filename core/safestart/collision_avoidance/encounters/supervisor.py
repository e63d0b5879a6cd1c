"""The hybrid supervisor of paper 001: nominal, evasive, recovery, and the guards (7) between them."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from safestart.collision_avoidance.encounters.clock import Clock
from safestart.collision_avoidance.encounters.observation import Moment, Observer
from safestart.collision_avoidance.encounters.pilots import evade
from safestart.collision_avoidance.encounters.slot import RECOVERY, Slot
from safestart.control.controller import Command
from safestart.control.pd import PdGains, pd_thrust
from safestart.model.scenario import Bools, Floats, number

Modes = NDArray[np.int8]


class Mode(IntEnum):
    """Modes of the automaton."""

    NOMINAL = 0
    EVASIVE = 1
    RECOVERY = 2


@dataclass(frozen=True, slots=True)
class Guards:
    """``level_m``: values up to it count as unsafe (the measured grid error); ``clearance_m``: an evasion ends this far
    above it (X_safe). Raises ``InvalidInput``."""

    level_m: float
    clearance_m: float

    def __post_init__(self) -> None:
        number("level_m", self.level_m, 0.0, 1e6)
        number("clearance_m", self.clearance_m, 0.0, 1e6)


@dataclass(slots=True)
class Supervisor:
    """Player 1 under supervision, for many flights in step; ``modes`` (N,) are their current modes.

    Nominal and recovery fly the PD law to the slot. Their guard looks one control period ahead: if the command,
    held for the period against the worst push, leads to a value not above the level, the evasion begins now and not a
    period too late. The evasion ends when the value exceeds the level by the clearance and the recovery's first period
    keeps it above. Recovery ends in the slot's box, whose speeds are the guard's epsilons.
    """

    observer: Observer
    slot: Slot
    guards: Guards
    clock: Clock
    gains: PdGains = RECOVERY
    modes: Modes = field(default_factory=lambda: np.empty(0, dtype=np.int8))
    switches: NDArray[np.int64] = field(default_factory=lambda: np.zeros((3, 3), dtype=np.int64))

    def begin(self, state: Floats) -> None:
        """All flights (N, 6) start nominal; ``switches`` keeps its counts."""
        self.modes = np.full(len(state), Mode.NOMINAL, dtype=np.int8)

    def command(self, k: int, state: Floats) -> Command:
        """See :class:`safestart.control.controller.Controller`; ``state`` (N, 6). Switches modes first."""
        game = self.observer.game
        seen = game.from_lvlh(state)
        moment = self.observer.look(k, seen, self.clock.to_go(k, self.observer.tube.horizon_s))
        steady = pd_thrust(seen, np.array(self.slot.centre), self.gains, game.control)
        ahead = self._ahead(moment, steady)
        threatened = ahead <= self.guards.level_m
        clear = ~threatened & (moment.value > self.guards.level_m + self.guards.clearance_m)
        # In the order in which one step can pass through them.
        self._switch(Mode.RECOVERY, Mode.NOMINAL, self.slot.holds(moment.states))
        self._switch(Mode.EVASIVE, Mode.RECOVERY, clear)
        self._switch(Mode.RECOVERY, Mode.EVASIVE, threatened)
        self._switch(Mode.NOMINAL, Mode.EVASIVE, threatened)
        evading = self.modes == Mode.EVASIVE
        steady[evading] = evade(game, moment.only(evading))
        return Command(game.thrust_to_lvlh(steady))

    def _ahead(self, moment: Moment, steady: Floats) -> Floats:
        """Value (N,) after one period of the command against the push that lowers it fastest."""
        game = self.observer.game
        worst = game.disturbance.extreme(-moment.gradient[:, game.channels :])
        period = self.clock.period_s
        states = moment.states @ game.transition(period).T
        states += (steady + worst) @ game.held_input(period).T
        return self.observer.read(states, moment.to_go)[0]

    def _switch(self, before: Mode, after: Mode, where: Bools) -> None:
        chosen = (self.modes == before) & where
        self.modes[chosen] = after
        self.switches[before, after] += int(chosen.sum())

"""The hybrid supervisor of paper 001: nominal, evasive, recovery, and the guards (7) between them."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from safestart.collision_avoidance.encounters.feedback import RECOVERY, Gains, Slot, command
from safestart.collision_avoidance.encounters.observation import Moment, Sight
from safestart.collision_avoidance.encounters.pilots import evade
from safestart.model.scenario import Bools, Floats, number

Modes = NDArray[np.int8]


class Mode(IntEnum):
    """Modes of the automaton."""

    NOMINAL = 0
    EVASIVE = 1
    RECOVERY = 2


@dataclass(frozen=True, slots=True)
class Guards:
    """``level_m``: a value at or under it counts as unsafe (the grid error measured); ``clearance_m``: how far above it
    an evasion ends (X_safe). Raises ``InvalidInput``."""

    level_m: float
    clearance_m: float

    def __post_init__(self) -> None:
        number("level_m", self.level_m, 0.0, 1e6)
        number("clearance_m", self.clearance_m, 0.0, 1e6)


@dataclass(slots=True)
class Supervisor:
    """Player 1 under supervision; one object flies one batch of encounters, since it remembers their modes.

    Nominal and recovery fly the PD law to the slot. Their guard looks one control period ahead: if the command,
    held for the period against the worst push, leads to a value at or under the level, the evasion begins now and
    not a period too late. The evasion ends where the value is above the level by the clearance and the recovery's
    first period keeps it above. Recovery ends in the slot's box, whose speeds are the guard's epsilons.
    """

    sight: Sight
    slot: Slot
    guards: Guards
    period_s: float
    gains: Gains = RECOVERY
    modes: Modes = field(default_factory=lambda: np.empty(0, dtype=np.int8))
    switches: NDArray[np.int64] = field(default_factory=lambda: np.zeros((3, 3), dtype=np.int64))

    def __call__(self, moment: Moment) -> Floats:
        """u (N, 2) at a moment; switches modes first."""
        if moment.step == 0:
            self.modes = np.full(len(moment.states), Mode.NOMINAL, dtype=np.int8)
        game = self.sight.game
        steady = command(moment.states, self.slot, self.gains, game.control)
        ahead = self._ahead(moment, steady)
        threatened = ahead <= self.guards.level_m
        clear = ~threatened & (moment.value > self.guards.level_m + self.guards.clearance_m)
        # In the order in which a state may pass through them within one step.
        self._switch(Mode.RECOVERY, Mode.NOMINAL, self.slot.holds(moment.states))
        self._switch(Mode.EVASIVE, Mode.RECOVERY, clear)
        self._switch(Mode.RECOVERY, Mode.EVASIVE, threatened)
        self._switch(Mode.NOMINAL, Mode.EVASIVE, threatened)
        evading = self.modes == Mode.EVASIVE
        steady[evading] = evade(game, moment.only(evading))
        return steady

    def _ahead(self, moment: Moment, steady: Floats) -> Floats:
        """Value (N,) after one period of the command against the push that lowers it fastest."""
        game = self.sight.game
        worst = game.disturbance.extreme(-moment.gradient[:, game.channels :])
        states = moment.states @ game.transition(self.period_s).T
        states += (steady + worst) @ game.held_input(self.period_s).T
        return self.sight.look(moment.step, states, moment.to_go).value

    def _switch(self, before: Mode, after: Mode, where: Bools) -> None:
        chosen = (self.modes == before) & where
        self.modes[chosen] = after
        self.switches[before, after] += int(chosen.sum())

"""Strategies of Player 1: evade by the value function, burn an escape mode, follow the PD law, or coast.

Near a head-on course the gradient of a gridded value cannot choose between left and right: both ways out have almost
the same value there. ``certified`` therefore flies the best constant sum u + d whenever
:func:`~safestart.collision_avoidance.bounds.certified.witness` proves that it keeps the distance, and the gradient
elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from safestart.collision_avoidance.bounds.certified import witness
from safestart.collision_avoidance.encounters.clock import Clock
from safestart.collision_avoidance.encounters.escape import MODES
from safestart.collision_avoidance.encounters.observation import Moment, Observer
from safestart.collision_avoidance.encounters.slot import EVASIVE, Slot
from safestart.collision_avoidance.game import Game
from safestart.control.controller import Command, Controller
from safestart.control.escape import Burn
from safestart.control.pd import Pd
from safestart.model.scenario import Floats

TITLES = {
    "certified": "HJ joined with the certified bound",
    "hj": "HJ, gradient alone",
    "supervisor": "supervisor",
    **{mode.name: f"escape mode {mode.title}" for mode in MODES},
    "pd": "PD, evasive gains",
    "coast": "coast",
}
PILOTS = tuple(name for name in TITLES if name != "supervisor")


@dataclass(frozen=True, slots=True)
class Watching:
    """The controller of a ``law`` that gives u (N, m) at a moment, for one state or many."""

    observer: Observer
    clock: Clock
    law: Callable[[Moment], Floats]

    def begin(self, state: Floats) -> None:
        """Nothing to forget."""

    def command(self, k: int, state: Floats) -> Command:
        """See :class:`safestart.control.controller.Controller`."""
        observer = self.observer
        seen = np.atleast_2d(observer.game.from_lvlh(state))
        push = self.law(observer.look(k, seen, self.clock.to_go(k, observer.tube.horizon_s)))
        return Command(observer.game.thrust_to_lvlh(push).reshape(*state.shape[:-1], 3))


def pilot(name: str, observer: Observer, clock: Clock, slot: Slot, fuel_price: float = 0.0) -> Controller:
    """The pilot of that name, for one state or many; no pilot has a memory.

    ``hj`` raises the value as fast as it can, and coasts if that is not worth ``fuel_price`` (m per m/s); a mode always
    burns at full thrust; ``pd`` follows the evasive PD law to the slot.
    """
    game = observer.game
    if name == "certified":
        return Watching(observer, clock, lambda moment: evade(game, moment))
    if name == "hj":
        return Watching(observer, clock, lambda moment: climb(game, moment, fuel_price))
    if name == "pd":
        return Pd(game.axes, slot.centre, EVASIVE, game.control)
    for mode in MODES:
        if mode.name == name:
            return Burn(game.thrust_to_lvlh(game.control.extreme(np.array(mode.direction))))
    return Burn(np.zeros(3))


def climb(game: Game, moment: Moment, fuel_price: float = 0.0) -> Floats:
    """The u (N, m) that raises the value fastest; zero if the gain is at most the price."""
    slope = moment.gradient[:, game.channels :]
    push = game.control.extreme(slope)
    for part in game.control.parts:
        gain = np.linalg.norm(slope[:, part.begin : part.end], axis=1, keepdims=True)
        push[:, part.begin : part.end] *= gain > fuel_price
    return push


def evade(game: Game, moment: Moment) -> Floats:
    """Thrust (N, m) for the best constant sum that is proved to keep the distance; without one, by the gradient."""
    push, left = climb(game, moment), game.realisable
    if left is None or moment.to_go <= 0.0:
        return push
    # The demanded sum, stretched to Player 1's own set: whatever d does, the sum goes at least that way.
    stretch = np.ones(game.channels)
    for own, part in zip(game.control.parts, left.parts, strict=True):
        stretch[part.begin : part.end] = own.radius / part.radius if part.radius > 0.0 else 0.0
    found = witness(game, moment.states, moment.to_go, effort=0)
    proved = found.margin_m > 0.0
    push[proved] = stretch * found.inputs[proved, 0]
    return push

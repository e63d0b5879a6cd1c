"""The saturated PD law of paper 001, eqs. (8) and (9), with the gains of its Table I and the slot that it holds."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.collision_avoidance.inputs import InputSet
from safestart.errors import invalid
from safestart.model.scenario import Bools, Floats, number


@dataclass(frozen=True, slots=True)
class Gains:
    """Gains by channel (tangential, radial): ``position`` in 1/s^2, ``speed`` in 1/s. Raises ``InvalidInput``."""

    position: tuple[float, float]
    speed: tuple[float, float]

    def __post_init__(self) -> None:
        for k in range(2):
            number(f"position[{k}]", self.position[k], 0.0, 1.0)
            number(f"speed[{k}]", self.speed[k], 0.0, 1.0)


RECOVERY = Gains((1.0e-4, 1.0e-4), (2.0e-2, 2.0e-2))
"""Table I, nominal and recovery."""

EVASIVE = Gains((5.0e-4, 5.0e-4), (4.4e-2, 4.4e-2))
"""Table I, evasive."""


@dataclass(frozen=True, slots=True)
class Slot:
    """The recovery set (16): ``centre`` (4,) and half-widths ``half`` (4,), m and m/s; the default is eq. (19)."""

    centre: tuple[float, float, float, float] = (1000.0, 0.0, 0.0, 0.0)
    half: tuple[float, float, float, float] = (50.0, 25.0, 0.01, 0.01)

    def __post_init__(self) -> None:
        if len(self.centre) != 4 or not all(map(math.isfinite, self.centre)):
            raise invalid("slot.centre", "four finite numbers", self.centre)
        if len(self.half) != 4 or not all(0.0 < value < math.inf for value in self.half):
            raise invalid("slot.half", "four positive finite numbers", self.half)

    def holds(self, states: Floats) -> Bools:
        """Whether states (..., 4) are inside, (...)."""
        inside: Bools = (np.abs(states - np.array(self.centre)) <= np.array(self.half)).all(axis=-1)
        return inside


def command(states: Floats, slot: Slot, gains: Gains, thrust: InputSet) -> Floats:
    """u (..., 2) in m/s^2 at states (..., 4): eqs. (8), (9), cut off at the limits of ``thrust``."""
    off = states - np.array(slot.centre)
    demand = -np.array(gains.position) * off[..., :2] - np.array(gains.speed) * off[..., 2:]
    return limited(demand, thrust)


def limited(demand: Floats, thrust: InputSet) -> Floats:
    """The input of ``thrust`` nearest to ``demand`` (..., m): every channel of a box by itself, a disk by its size."""
    found = np.array(demand)
    for part in thrust.parts:
        size = np.linalg.norm(found[..., part.begin : part.end], axis=-1, keepdims=True)
        found[..., part.begin : part.end] *= part.radius / np.maximum(size, max(part.radius, 1e-300))
    return found

"""The slot of paper 001's PD law, and the gains of Table I; axes (tangential, radial)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.control.pd import PdGains
from safestart.errors import invalid
from safestart.model.scenario import Bools, Floats

RECOVERY = PdGains((1.0e-4, 1.0e-4), (2.0e-2, 2.0e-2))
"""Table I, nominal and recovery."""

EVASIVE = PdGains((5.0e-4, 5.0e-4), (4.4e-2, 4.4e-2))
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

"""An open-loop burn: a fixed thrust in LVLH axes for a time, then drift (paper 001, section III-C)."""

from __future__ import annotations

import math

import numpy as np

from safestart.control.controller import Command
from safestart.model.scenario import Floats


class Burn:
    """``thrust`` (3,), m/s^2, in every interval of ``dt`` seconds that begins before ``burn_s``; one state or many."""

    def __init__(self, thrust: Floats, burn_s: float = math.inf, dt: float = 1.0) -> None:
        self._thrust, self._burn, self._dt = thrust, burn_s, dt

    def begin(self, state: Floats) -> None:
        """Nothing to forget."""

    def command(self, k: int, state: Floats) -> Command:
        """See :class:`safestart.control.controller.Controller`."""
        shape = (*state.shape[:-1], 3)
        burning = k * self._dt < self._burn
        return Command(np.broadcast_to(self._thrust, shape) if burning else np.zeros(shape))

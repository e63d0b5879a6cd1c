"""A thrust history to the hold point, then the LQR there: the flight whose terminal set `synchronize` proves."""

from __future__ import annotations

import numpy as np

from safestart.control.controller import Command
from safestart.control.hold.hold_lqr import HoldLqr
from safestart.model.scenario import Floats


class ArriveAndHold:
    """Planar. The ``history`` (N, 2), LVLH m/s^2, is flown as it is, whatever state is met; then the ``hold`` flies,
    from interval N on, where it reads the body's angle from the interval's number."""

    def __init__(self, history: Floats, hold: HoldLqr) -> None:
        self._history, self._hold = history, hold

    def begin(self, state: Floats) -> None:
        """Nothing to forget."""

    def command(self, k: int, state: Floats) -> Command:
        """See :class:`safestart.control.controller.Controller`."""
        if k < len(self._history):
            return Command(np.array([*self._history[k], 0.0]), label="arrive")
        return self._hold.command(k, state)

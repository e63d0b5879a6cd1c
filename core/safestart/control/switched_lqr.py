"""Switched state feedback (paper 003): one gain far from the target, another within a guard, none once engines fail.

:mod:`safestart.passive_safety` computes reach tubes and flights of the same law in continuous time, in the paper's
metres and minutes; this is a controller in SI for any plant.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from safestart.control.controller import Command
from safestart.errors import invalid
from safestart.model.scenario import Floats


class SwitchedLqr:
    """u = -K x in the orbit plane, x = (x, y, vx, vy) in LVLH, the gains (2, 4) in 1/s^2 and 1/s.

    ``inside`` tells whether a position (2,), m, is within the guard; after that the ``near`` gain stays. From
    ``abort_s`` on, counted in intervals of ``dt`` seconds, nothing is commanded. Raises ``InvalidInput`` for gains of
    another shape.
    """

    def __init__(
        self,
        far: Floats,
        near: Floats,
        inside: Callable[[Floats], bool],
        dt: float,
        abort_s: float = math.inf,
    ) -> None:
        for name, gain in (("far", far), ("near", near)):
            if np.shape(gain) != (2, 4):
                raise invalid(name, "a gain of shape (2, 4)", np.shape(gain))
        self._gains = {"far": far, "near": near}
        self._inside, self._dt, self._abort = inside, dt, abort_s
        self._mode = "far"

    def begin(self, state: Floats) -> None:  # noqa: ARG002
        """Begin with the far gain."""
        self._mode = "far"

    def command(self, k: int, state: Floats) -> Command:
        """See :class:`safestart.control.controller.Controller`; labels are ``far``, ``near`` and ``passive``."""
        thrust = np.zeros(3)
        if k * self._dt >= self._abort:
            return Command(thrust, label="passive")
        seen = state[[0, 1, 3, 4]]
        if self._inside(seen[:2]):
            self._mode = "near"
        thrust[:2] = -(self._gains[self._mode] @ seen)
        return Command(thrust, label=self._mode)

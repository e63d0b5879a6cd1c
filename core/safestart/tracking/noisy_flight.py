"""Flights with errors of navigation, input, spin and inertia, in one of three variants of the controller.

The controller measures the attitude at every node, believes a rate and an inertia that are off, and predicts the
attitudes ahead from them. ``hard`` follows its last plan where there is none that keeps every row, ``soft`` takes the
least violation, ``tube`` plans with a Kalman filter and tightened rows, and softly where these have no plan. ``hard``
and ``soft`` plan from raw measurements.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from safestart.control.tracking_mpc.controller import Program
from safestart.model.scenario import Floats
from safestart.tracking.noisy_kernel import HARD, SOFT, TUBE, fly_noisy

Variant = Literal["hard", "soft", "tube"]
_CODES = {"hard": HARD, "soft": SOFT, "tube": TUBE}


@dataclass(frozen=True, slots=True)
class Belief:
    """``inertia`` (3, 3) that the controller has; ``orbit`` rad/s: LVLH's own turn, 0 where it is left out."""

    inertia: Floats
    orbit: float


@dataclass(frozen=True, slots=True)
class NoisyOutcome:
    """``least_slack`` m at the nodes, ``largest_input`` m/s (per axis, or in length in a ball), ``impulse`` m/s.

    ``last_range``, m; ``unplanned``: steps without a plan that keeps every row.
    """

    least_slack: float
    largest_input: float
    impulse: float
    last_range: float
    unplanned: int


class NoisyFlights:
    """One controller; ``gain`` (6, 6) of its filter, None: measurements as they are."""

    def __init__(self, program: Program, belief: Belief, variant: Variant, gain: Floats | None) -> None:
        motion = program.motion
        self._head = (
            np.ascontiguousarray(belief.inertia),
            np.linalg.inv(belief.inertia),
            float(belief.orbit),
            float(motion.period),
            motion.a,
            motion.b,
            np.eye(6) if gain is None else np.ascontiguousarray(gain),
            _CODES[variant],
        )
        offsets = np.ascontiguousarray(program.faces.offsets)
        self._tail = (
            program.fixed,
            program.tuning.input_limit == "ball",
            offsets,
            program.low,
            program.high,
            program.give,
        )

    def fly(
        self, start: Floats, attitudes: Floats, rates: Floats, navigation: Floats, sizes: Floats
    ) -> NoisyOutcome:
        """One flight from an LVLH ``start`` (6,); see :func:`fly_noisy` for the arrays."""
        least, largest, impulse, last, unplanned = fly_noisy(
            np.asarray(start, dtype=np.float64), attitudes, rates, *self._head, navigation, sizes, *self._tail
        )
        return NoisyOutcome(float(least), float(largest), float(impulse), float(last), int(unplanned))

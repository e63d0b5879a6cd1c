"""A steady spin against LVLH about a fixed axis; paper 000's target spins about z (eq. 3)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.attitude.turning import Bounds, of_rates
from safestart.errors import invalid
from safestart.model.scenario import MAX_TUMBLE_RATE, Floats, Target, number


@dataclass(frozen=True, slots=True)
class Spin:
    """``rate`` rad/s (either sign) about ``axis``, a direction that LVLH and body share; ``phase`` rad at t = 0.

    The axis is scaled to unit length. Raises ``InvalidInput`` for non-finite numbers, a rate out of range, and an axis
    of length 0.
    """

    rate: float
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    phase: float = 0.0

    def __post_init__(self) -> None:
        number("rate", self.rate, -MAX_TUMBLE_RATE, MAX_TUMBLE_RATE)
        number("phase", self.phase, -1e6, 1e6)
        length = math.hypot(*self.axis)
        if len(self.axis) != 3 or not 0.0 < length < math.inf:
            raise invalid("axis", "three finite numbers, not all 0", self.axis)
        object.__setattr__(self, "axis", tuple(float(e) / length for e in self.axis))

    @property
    def planar(self) -> bool:
        """Whether the axis is +z or -z, so that the orbit plane turns within itself."""
        return self.axis[:2] == (0.0, 0.0)

    def angle(self, times: Floats) -> Floats:
        """Angle by which the body is ahead of LVLH about the axis, rad, at ``times`` (...)."""
        out: Floats = self.phase + self.rate * np.asarray(times, dtype=np.float64)
        return out

    def rotation(self, times: Floats) -> Floats:
        """(..., 3, 3): LVLH coordinates to body coordinates."""
        return self.turned_by(self.angle(times))

    def turned_by(self, angles: Floats) -> Floats:
        """The rotation after ``angles`` (...), rad: a a' + cos (I - a a') - sin [a x].

        For an axis of the frame every entry is 0, 1 or a plain cosine or sine.
        """
        angle = np.asarray(angles, dtype=np.float64)[..., None, None]
        x, y, z = self.axis
        along = np.outer(self.axis, self.axis)
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        out: Floats = along + np.cos(angle) * (np.eye(3) - along) - np.sin(angle) * cross
        return out

    def angular_velocity(self, times: Floats) -> Floats:
        """(..., 3): the same at all times and in both frames."""
        return np.broadcast_to(self.rate * np.array(self.axis), (*np.shape(times), 3))

    def rate_bounds(self) -> tuple[float, float]:
        """|rate| and 0."""
        return abs(self.rate), 0.0

    @property
    def knots(self) -> Floats:
        """A spin has no knots."""
        return np.empty(0)

    def turn_bounds(self) -> Bounds:
        """Bound the derivatives of the rotation by powers of the rate."""
        return of_rates(abs(self.rate), 0.0, 0.0, 0.0)


def spin_of(target: Target) -> Spin:
    """The spin about z of a scenario's target, body and LVLH aligned at t = 0."""
    return Spin(target.tumble_rate)

"""Bounds on the first four derivatives of directions that are fixed in a turning body.

With sizes w, w1, w2, w3 of the angular velocity and its derivatives, a direction of the body has, seen from the
reference, derivatives of at most w, w^2 + w1, w^3 + 3 w w1 + w2 and w^4 + 6 w^2 w1 + 4 w w2 + 3 w1^2 + w3: each
derivative turns the terms so far and differentiates them (Bell polynomials).
"""

from __future__ import annotations

import math
from typing import Protocol

from safestart.attitude.attitude import Attitude
from safestart.model.scenario import Floats

Bounds = tuple[float, float, float, float]


class SmoothAttitude(Attitude, Protocol):
    """An attitude with bounds on four derivatives, which hold between ``knots`` but not at them."""

    @property
    def knots(self) -> Floats:
        """Times (K,), s; empty for most attitudes."""
        ...

    def turn_bounds(self) -> Bounds:
        """Bounds, rad/s^k, on the first four derivatives of a unit vector of the body seen from the reference."""
        ...


def of_rates(w: float, w1: float, w2: float, w3: float) -> Bounds:
    """Bounds on a direction's derivatives from those on the angular velocity and its first three."""
    return (
        w,
        w * w + w1,
        w**3 + 3.0 * w * w1 + w2,
        w**4 + 6.0 * w * w * w1 + 4.0 * w * w2 + 3.0 * w1 * w1 + w3,
    )


def product(first: Bounds, second: Bounds) -> Bounds:
    """Bounds for a frame that turns by ``second`` in a frame that turns by ``first`` (Leibniz)."""
    a, b = (1.0, *first), (1.0, *second)
    found = [sum(math.comb(k, j) * a[j] * b[k - j] for j in range(k + 1)) for k in range(1, 5)]
    return found[0], found[1], found[2], found[3]

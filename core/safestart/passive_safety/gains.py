"""Feedback gains of modes 1 and 2: the published ones, digit by digit, and our LQR gains by Bryson's rule.

Bryson's rule (paper 003, section 3.4): Q and R are diagonal with the inverse squares of the largest desired values. The
limits of :data:`PUBLISHED_DESIGN`, which the paper does not print, reproduce the published gains to 1e-7 of their
largest entries. Units: m, min, kg.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import numpy as np
from scipy.linalg import solve_continuous_are

from safestart.model.scenario import Floats, number

Row = tuple[Fraction, Fraction, Fraction, Fraction]


@dataclass(frozen=True, slots=True)
class Bryson:
    """Largest desired values in one mode: ``position`` (x, y), m, ``speed`` (vx, vy), m/min, ``thrust``, kg m/min^2.

    Only their ratios to ``thrust`` matter. Raises ``InvalidInput``.
    """

    position: tuple[float, float]
    speed: tuple[float, float]
    thrust: float

    def __post_init__(self) -> None:
        for k in range(2):
            number(f"position[{k}]", self.position[k], 1e-3, 1e6)
            number(f"speed[{k}]", self.speed[k], 1e-3, 1e6)
        number("thrust", self.thrust, 1e-3, 1e9)


@dataclass(frozen=True, slots=True)
class Design:
    """Bryson limits of mode 1 (``far``) and mode 2 (``near``)."""

    far: Bryson
    near: Bryson


PUBLISHED_DESIGN = Design(
    Bryson((1000.0, 866.0), (20.0, 20.0), 28_800.0), Bryson((100.0, 100.0), (3.0, 3.0), 28_800.0)
)
"""8 N; 1000 m by 866 m and 1/3 m/s in mode 1; 100 m and 5 cm/s in mode 2: derived from the published gains."""

_PUBLISHED = (
    (
        ("28.828677676943", "-0.100479948259883", "1449.97541985328", "-0.00462447231887482"),
        ("0.0870156786852279", "33.2561992450513", "-0.00462447231887482", "1451.50134643428"),
    ),
    (
        ("288.028766271474", "-0.131243039715836", "9614.98979543236", "3.41199965400404e-7"),
        ("0.131243040368934", "287.999970095943", "3.41199965400404e-7", "9614.98829796995"),
    ),
)


def published_gain(near: bool) -> tuple[Row, Row]:
    """K (2, 4) of u = -K x as printed: mode 2 if ``near``, else mode 1."""
    first, second = ([Fraction(entry) for entry in line] for line in _PUBLISHED[int(near)])
    return (first[0], first[1], first[2], first[3]), (second[0], second[1], second[2], second[3])


@cache
def bryson_gain(limits: Bryson, drift: tuple[tuple[float, ...], ...], mass: float) -> Floats:
    """LQR gain (2, 4) for the motion ``drift`` (A, 4 x 4) of a chaser of ``mass`` kg: K = R^-1 B' P."""
    b = np.vstack([np.zeros((2, 2)), np.eye(2) / mass])
    # In units of the thrust limit: R = 1 keeps the Riccati equation well scaled.
    q = np.diag((limits.thrust / np.array([*limits.position, *limits.speed])) ** 2)
    gain: Floats = b.T @ np.asarray(solve_continuous_are(np.array(drift), b, q, np.eye(2)))
    return gain

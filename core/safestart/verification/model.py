"""The published rendezvous model (paper 003 and the competition files made from it): numbers, exactly as printed.

Units: m, min, kg. One newton is 3600 kg m/min^2, 1 m/min is 1/60 m/s. Coefficients are kept as decimal fractions,
so that the proofs are about the printed numbers and not about their nearest doubles.
"""

from __future__ import annotations

import math
from enum import StrEnum
from fractions import Fraction
from functools import cache

import numpy as np

from safestart.scenario import Floats

MASS = 500
"""Chaser mass, kg."""

NEWTON = 3600.0
"""One newton in kg m/min^2."""

MAX_THRUST = 10.0 * NEWTON
"""Thrust limit per axis, kg m/min^2 (10 N)."""

MAX_SPEED = 3.0
"""Speed limit in mode 2, m/min (5 cm/s)."""

GAP_GUARD, GAP_DIAGONAL = 100.0, 141.1
"""Guard octagon of mode 1 -> 2: |x|, |y| <= 100 m and |x +- y| <= 141.1 m (100 sqrt 2, rounded as published)."""

LOS_SLOPE = math.tan(math.radians(30.0))
"""Half-opening of the line-of-sight cone |y| <= -x tan 30 degrees, which is cut at x >= -100 m."""

TWO_N = Fraction("0.00876276")
"""2n of the published linear model, rad/min (its n implies an orbit of 42 125 km, not the paper's 42 164 km)."""

_THREE_N2 = Fraction("5.75894721132e-5")

_GAINS = {
    1: (
        ("28.828677676943", "-0.100479948259883", "1449.97541985328", "-0.00462447231887482"),
        ("0.0870156786852279", "33.2561992450513", "-0.00462447231887482", "1451.50134643428"),
    ),
    2: (
        ("288.028766271474", "-0.131243039715836", "9614.98979543236", "3.41199965400404e-7"),
        ("0.131243040368934", "287.999970095943", "3.41199965400404e-7", "9614.98829796995"),
    ),
}


class Mode(StrEnum):
    """Discrete modes: far approach, near approach, engines off."""

    FAR = "mode1"
    NEAR = "mode2"
    PASSIVE = "passive"


@cache
def exact_matrix(mode: Mode) -> tuple[tuple[Fraction, ...], ...]:
    """System matrix of a mode as fractions, 4 x 4: A of the passive motion (eq. 2), minus B K in modes 1 and 2."""
    rows = [
        [Fraction(0), Fraction(0), Fraction(1), Fraction(0)],
        [Fraction(0), Fraction(0), Fraction(0), Fraction(1)],
        [_THREE_N2, Fraction(0), Fraction(0), TWO_N],
        [Fraction(0), Fraction(0), -TWO_N, Fraction(0)],
    ]
    if mode is not Mode.PASSIVE:
        for row, line in zip(rows[2:], _GAINS[1 if mode is Mode.FAR else 2], strict=True):
            for j, entry in enumerate(line):
                row[j] -= Fraction(entry) / MASS
    return tuple(tuple(row) for row in rows)


@cache
def matrix(mode: Mode) -> Floats:
    """The same matrix (4, 4) in doubles, each entry correctly rounded."""
    return np.array([[float(entry) for entry in row] for row in exact_matrix(mode)])


@cache
def gain(mode: Mode) -> Floats:
    """K (2, 4) of u = -K x, kg/min^2 and kg/min; zero in the passive mode."""
    if mode is Mode.PASSIVE:
        return np.zeros((2, 4))
    return np.array([[float(entry) for entry in line] for line in _GAINS[1 if mode is Mode.FAR else 2]])


def octagon(half: float, diagonal: float) -> tuple[Floats, Floats]:
    """Rows (8, 2) and limits (8,) of |a|, |b| <= half, |a +- b| <= diagonal."""
    rows = np.array([[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, -1], [1, -1], [-1, 1]], dtype=np.float64)
    return rows, np.array([half] * 4 + [diagonal] * 4)


FACES, FACE_LIMITS = octagon(GAP_GUARD, GAP_DIAGONAL)
"""Guard octagon: rows (8, 2) on the position, limits (8,) in metres."""

FACE_NAMES = ("x=100", "x=-100", "y=100", "y=-100", "x+y=141.1", "x+y=-141.1", "x-y=141.1", "x-y=-141.1")
"""Names of the faces, in the order of :data:`FACES`."""

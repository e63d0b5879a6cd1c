"""The switched rendezvous (paper 003 and the competition files made from it): its numbers, exactly as printed.

Units: m, min, kg. One newton is 3600 kg m/min^2, 1 m/min is 1/60 m/s. Coefficients are fractions, so that the proofs
are about the printed numbers and not about their nearest doubles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from functools import cache

import numpy as np

from safestart.model.scenario import Floats
from safestart.passive_safety.gains import Design, bryson_gain, published_gain
from safestart.passive_safety.switching_guard import Guard

MASS = 500
"""Chaser mass, kg."""

NEWTON = 3600.0
"""One newton in kg m/min^2."""

MAX_THRUST = 10.0 * NEWTON
"""Thrust limit per axis, kg m/min^2 (10 N)."""

MAX_SPEED = 3.0
"""Speed limit in mode 2, m/min (5 cm/s)."""

LOS_SLOPE = math.tan(math.radians(30.0))
"""Half-opening of the line-of-sight cone |y| <= -x tan 30 degrees, which is cut at x >= -100 m."""

MU, RADIUS = 3.986e14 * 3600.0, 42_164e3
"""Earth's gravitational parameter (m^3/min^2) and the target's orbit radius (m) of the nonlinear model."""

_LINEAR = Fraction("5.75894721132e-5"), Fraction("0.00876276")
_N2 = Fraction("3.986e14") * 3600 / Fraction(42_164_000) ** 3
_ROOT_SCALE = 10**60
_NONLINEAR = 3 * _N2, 2 * Fraction(math.isqrt(int(_N2 * _ROOT_SCALE**2)), _ROOT_SCALE)


class Mode(StrEnum):
    """Discrete modes: far approach, near approach, engines off."""

    FAR = "mode1"
    NEAR = "mode2"
    PASSIVE = "passive"


class Dynamics(StrEnum):
    """Relative motion: Clohessy-Wiltshire-Hill with the published coefficients, or Kepler's (eq. 1)."""

    LINEAR = "linear"
    NONLINEAR = "nonlinear"


@dataclass(frozen=True, slots=True)
class Motion:
    """The linear part of one mode; ``design`` None: published gains. Keys every table of matrix exponentials."""

    mode: Mode
    dynamics: Dynamics = Dynamics.LINEAR
    design: Design | None = None


@dataclass(frozen=True, slots=True)
class System:
    """The switched system: relative ``dynamics``, gains (``design``, None: the published ones) and ``guard``."""

    dynamics: Dynamics = Dynamics.LINEAR
    design: Design | None = None
    guard: Guard = Guard.OCTAGON

    def motion(self, mode: Mode) -> Motion:
        """Linear part of the motion in ``mode``; for nonlinear dynamics the linearisation at the target."""
        return Motion(mode, self.dynamics, None if mode is Mode.PASSIVE else self.design)


PUBLISHED = System()
"""Linear motion, published gains, octagon: the model of the competition."""


def coefficients(dynamics: Dynamics) -> tuple[Fraction, Fraction]:
    """3 n^2 (1/min^2) and 2 n (1/min).

    The published linear n implies an orbit of 42 125 km, not the paper's 42 164 km; we use both as printed. The
    nonlinear 2 n is rounded at 60 digits; the remainder's own rounding covers this.
    """
    return _LINEAR if dynamics is Dynamics.LINEAR else _NONLINEAR


@cache
def exact_gain(motion: Motion) -> tuple[tuple[Fraction, ...], ...]:
    """K (2, 4) of u = -K x as fractions, kg/min^2 and kg/min; zero in the passive mode."""
    if motion.mode is Mode.PASSIVE:
        return ((Fraction(0),) * 4,) * 2
    near = motion.mode is Mode.NEAR
    if motion.design is None:
        return published_gain(near)
    limits = motion.design.near if near else motion.design.far
    drift = matrix(Motion(Mode.PASSIVE, motion.dynamics))
    gain = bryson_gain(limits, tuple(tuple(float(v) for v in row) for row in drift), float(MASS))
    return tuple(tuple(Fraction(float(entry)) for entry in row) for row in gain)


@cache
def exact_matrix(motion: Motion) -> tuple[tuple[Fraction, ...], ...]:
    """Matrix of the linear part as fractions, 4 x 4: A of the passive motion (eq. 2), minus B K in modes 1 and 2."""
    three_n2, two_n = coefficients(motion.dynamics)
    rows = [
        [Fraction(0), Fraction(0), Fraction(1), Fraction(0)],
        [Fraction(0), Fraction(0), Fraction(0), Fraction(1)],
        [three_n2, Fraction(0), Fraction(0), two_n],
        [Fraction(0), Fraction(0), -two_n, Fraction(0)],
    ]
    for row, line in zip(rows[2:], exact_gain(motion), strict=True):
        for j, entry in enumerate(line):
            row[j] -= entry / MASS
    return tuple(tuple(row) for row in rows)


@cache
def matrix(motion: Motion) -> Floats:
    """The dynamics' matrix (4, 4) in doubles, each entry correctly rounded."""
    return np.array([[float(entry) for entry in row] for row in exact_matrix(motion)])


@cache
def gain(motion: Motion) -> Floats:
    """K (2, 4) in doubles, each entry correctly rounded."""
    return np.array([[float(entry) for entry in line] for line in exact_gain(motion)])

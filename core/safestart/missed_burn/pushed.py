"""What a push at another time is as a state at the planned one: f(s) = Phi(0, s) (0, I) and its integral.

In CWH motion both are closed forms, about the true Earth polynomials through samples (f turns with LVLH there and is
analytic). |f'| and |f''| are bounded with |Phi_pp| <= cosh k s, |Phi_pv| <= sinh(k s)/k, k^2 = K >= |G|:

    f' = Phi(0, s) (-e, omega x e),   f'' = Phi(0, s) (-2 omega x e, G e + omega x (omega x e) + omega' x e).
"""

from __future__ import annotations

import math
from typing import Any, Protocol

import numpy as np
from numpy.polynomial import chebyshev

from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.dynamics.two_body_kernel import frame_of
from safestart.missed_burn.earth.motion import Drift, inverse, moved
from safestart.model.scenario import Floats

_NODES = 24
CHECKED = 64
"""The checker takes f's integral by the midpoints of so many parts of the longest time; its error is added here."""


class Pushed(Protocol):
    """Pushes of one burn; times in s after its planned time, e in LVLH."""

    def at(self, seconds: float) -> Floats:
        """f (6, 3)."""

    def total(self, seconds: float) -> Floats:
        """Integral of f (6, 3) from 0 on."""

    def rates(self, longest: float) -> tuple[Floats, Floats]:
        """Bounds (6,) on |f'| and |f''|, |e| = 1, up to ``longest`` s."""

    def loose(self, seconds: float) -> Floats:
        """Bound (6,) on the checker's error of the integral over so many s, |e| = 1."""


class CwhPushed:
    """In CWH motion, phases n t <= 1/2."""

    def __init__(self, n: float) -> None:
        self.n = n

    def at(self, seconds: float) -> Floats:
        """f (6, 3)."""
        return transition_matrix(self.n, -seconds)[:, 3:]

    def total(self, seconds: float) -> Floats:
        """Its integral (6, 3)."""
        return -input_matrix(self.n, -seconds)

    def rates(self, longest: float) -> tuple[Floats, Floats]:
        """Bounds (6,) on the first and second derivative."""
        n, p = self.n, self.n * longest
        slow = np.repeat([1.0 + 2.0 * p, n * (2.0 + 4.0 * p)], 3)
        return slow, n * np.repeat([2.0 + 4.0 * p, n * (8.0 + 16.0 * p)], 3)

    def loose(self, seconds: float) -> Floats:  # noqa: ARG002
        """The checker has the closed form."""
        return np.zeros(6)


class EarthPushed:
    """Near a reference about the true Earth; ``longest`` s is the longest time asked for."""

    def __init__(self, drift: Drift, longest: float) -> None:
        self.k, self.spin, self.bend = math.sqrt(drift.stiffness), drift.turning.spin, drift.turning.bend
        self.longest = longest
        nodes = np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)[::-1]
        target, chaser, now = drift.target, drift.chaser, 0.0
        phi: Floats = np.eye(6)
        values: list[Floats] = []
        for seconds in (0.5 * longest * (1.0 + nodes)).tolist():
            target, _ = moved(target, seconds - now)
            chaser, step = moved(chaser, seconds - now)
            phi, now = step @ phi, seconds
            rows, omega = np.empty((3, 3)), np.empty(3)
            frame_of(target, rows, omega)
            values.append((inverse(phi)[:, 3:] @ rows.T).ravel())
        f: Any = chebyshev.chebfit(nodes, np.array(values), _NODES - 1)
        total: Any = chebyshev.chebint(f, lbnd=-1.0, axis=0)
        self._f, self._total = f, 0.5 * longest * total

    def at(self, seconds: float) -> Floats:
        """f (6, 3)."""
        return self._summed(seconds, self._f)

    def total(self, seconds: float) -> Floats:
        """Its integral (6, 3)."""
        return self._summed(seconds, self._total)

    def _summed(self, seconds: float, coefficients: Any) -> Floats:
        values: Any = chebyshev.chebval(2.0 * seconds / self.longest - 1.0, coefficients)
        return np.asarray(values, dtype=np.float64).reshape(6, 3)

    def rates(self, longest: float) -> tuple[Floats, Floats]:
        """Bounds (6,) on the first and second derivative."""
        k, spin, both = self.k, self.spin, self.k**2 + self.bend
        even, odd = math.cosh(k * longest), math.sinh(k * longest)
        first = np.repeat([even + spin / k * odd, k * odd + spin * even], 3)
        second = np.repeat([2.0 * spin * even + both / k * odd, 2.0 * spin * k * odd + both * even], 3)
        return first, second

    def loose(self, seconds: float) -> Floats:
        """The error of midpoints, for a column and the centre in all three axes."""
        width = self.longest / CHECKED
        out: Floats = 6.0 * (seconds + width) * width**2 / 24.0 * self.rates(self.longest)[1]
        return out

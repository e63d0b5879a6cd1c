"""Jacobi's elliptic functions, and the argument of a theta function, given the complement m1 = 1 - m of the parameter.

Using m1 instead of m keeps accuracy near the separatrix, where m1 is tiny and a quarter period K is as long as
-log(m1).

sn, cn and dn come from Gauss's descending transformation (DLMF 22.7(i)): a sine at modulus 0, and rational steps back
in which no terms cancel. Theta(v + i b) = theta_4, b > 0, comes from its infinite product (DLMF 20.5), for m > 1/2
after Jacobi's imaginary transformation (DLMF 20.7(viii)), so that a handful of factors is always enough.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.special import elliprf

from safestart.model.scenario import Floats

Complexes = np.ndarray[tuple[int, ...], np.dtype[np.complex128]]
_LEAST_COMPLEMENT = 1e-300
"""Smaller complements, including 0, are replaced by this one: K is then 346, and no flight lasts so long."""
_FACTORS = 7
"""Factors of a product: with a nome of at most exp(-pi) the next one differs from 1 by less than 1e-18."""


def first_kind(cosine: float, sine: float, complement: float) -> float:
    """F(phi | m), |phi| <= pi, from cos phi and sin phi; inf where it is infinite."""
    if cosine < 0.0:
        whole = 2.0 * quarter_period(complement)
        return math.copysign(whole, sine) - first_kind(-cosine, sine, complement)
    square = cosine * cosine
    return sine * float(elliprf(square, square + complement * sine * sine, 1.0))


def quarter_period(complement: float) -> float:
    """K, by the arithmetic-geometric mean; inf for m1 = 0."""
    a, b = 1.0, math.sqrt(complement)
    if b == 0.0:
        return math.inf
    while abs(a - b) > 1e-16 * a:
        a, b = 0.5 * (a + b), math.sqrt(a * b)
        if abs(a - b) < 1e-8 * a:
            a, b = 0.5 * (a + b), math.sqrt(a * b)
            break
    return math.pi / (a + b)


class Jacobi:
    """The functions for one complement m1 in [0, 1]; giving m as well keeps accuracy at both ends."""

    def __init__(self, parameter: float, complement: float) -> None:
        self.parameter, self.complement = parameter, max(complement, _LEAST_COMPLEMENT)
        self.quarter = quarter_period(self.complement)
        self.other_quarter = quarter_period(parameter)
        # Moduli of Gauss's steps as (k, 1 - k, k'), from the first step on.
        self._steps: list[tuple[float, float]] = []
        modulus, other = math.sqrt(parameter), math.sqrt(self.complement)
        while modulus > 1e-9:
            # (1 - k') / (1 + k') = k^2 / (1 + k')^2, and its complement 2 k' / (1 + k').
            modulus, left, other = (
                (modulus / (1.0 + other)) ** 2,
                2.0 * other / (1.0 + other),
                2.0 * math.sqrt(other) / (1.0 + other),
            )
            self._steps.append((modulus, left))

    def reduced(self, u: Floats) -> tuple[Floats, Floats]:
        """u less a whole number of half periods 2 K, in [-K, K], and the sign (-1)^number."""
        number = np.round(u / (2.0 * self.quarter))
        left: Floats = u - 2.0 * self.quarter * number
        half = 0.5 * number
        sign: Floats = 1.0 - 4.0 * (half - np.floor(half))
        return left, sign

    def functions(self, u: Floats) -> tuple[Floats, Floats, Floats]:
        """sn, cn and dn at ``u`` (...)."""
        left, sign = self.reduced(np.asarray(u, dtype=np.float64))
        scale = 1.0
        for modulus, _ in self._steps:
            scale *= 1.0 + modulus
        angle = left / scale
        s, c = np.sin(angle), np.cos(angle)
        d = np.ones_like(s)
        for modulus, rest in reversed(self._steps):
            square = modulus * s * s
            above = 1.0 + square
            # 1 - k s^2 = (1 - k) + k c^2, with cn^2 for c^2: no cancellation.
            s, c, d = (
                (1.0 + modulus) * s / above,
                c * d / above,
                (rest + modulus * c * c) / above,
            )
        return sign * s, sign * c, d


class ThetaArgument:
    """exp(i arg Theta(u + i (K' - ``depth``))), and the slope of the argument at u = 0, for real u.

    Theta is Jacobi's theta function of period 2 K without zeros there; ``depth`` > 0 is the distance to its zero.
    """

    def __init__(self, jacobi: Jacobi, depth: float) -> None:
        self.jacobi = jacobi
        k, other = jacobi.quarter, jacobi.other_quarter
        self.direct = jacobi.parameter <= 0.5
        pi = math.pi
        if self.direct:
            powers = np.arange(_FACTORS)
            nome = math.exp(-pi * other / k) if math.isfinite(other) else 0.0
            first = math.exp(-pi * depth / k) if math.isfinite(depth) else 0.0
            # q^2 / r, r the first factor's.
            second = math.exp(-pi * (2.0 * other - depth) / k) if math.isfinite(other) else 0.0
            self._with, self._against = first * nome ** (2.0 * powers), second * nome ** (2.0 * powers)
            lead = first / -math.expm1(-pi * depth / k) if math.isfinite(depth) else 0.0
            rest = float((self._with[1:] / (1.0 - self._with[1:])).sum())
            back = float((self._against / (1.0 - self._against)).sum())
            self.slope = (pi / k) * (lead + rest - back)
            return
        # a = pi (K' - depth) / (2 K'): its sine and cosine from the depth, which may be small.
        part = 0.5 * pi * depth / other
        self._cos, self._sin = math.sin(part), math.cos(part)
        self._nomes = np.exp(-pi * k / other * 2.0 * np.arange(1, _FACTORS))
        self._twice = complex(self._cos, self._sin) ** 2
        self._along = math.pi * (other - depth) / (2.0 * k * other)
        factors = self._nomes * self._twice
        bend = 4.0 * float((factors / (1.0 + factors)).imag.sum())
        self.slope = 0.5 * pi / other * (self._sin / self._cos + bend) - self._along

    def direction(self, u: Floats) -> Complexes:
        """Unit complex numbers (...)."""
        left, _ = self.jacobi.reduced(np.asarray(u, dtype=np.float64))
        out: Complexes = self._direct(left) if self.direct else self._transformed(left)
        out /= np.sqrt(out.real * out.real + out.imag * out.imag)
        return out

    def _direct(self, u: Floats) -> Any:
        v = 0.5 * math.pi / self.jacobi.quarter * u
        s, c = np.sin(v), np.cos(v)
        twice_sine, versed = 2.0 * s * c, 2.0 * s * s
        out = np.ones(u.shape, dtype=np.complex128)
        for along, against in zip(self._with.tolist(), self._against.tolist(), strict=True):
            # 1 - g exp(-2 i v) and 1 - g exp(2 i v), with 1 - g cos 2v = (1 - g) + g (1 - cos 2v).
            for g, sign in ((along, 1.0), (against, -1.0)):
                if g < 1e-18:
                    continue
                factor = np.empty(u.shape, dtype=np.complex128)
                factor.real, factor.imag = (1.0 - g) + g * versed, sign * g * twice_sine
                out *= factor
        return out

    def _transformed(self, u: Floats) -> Any:
        grown = 0.5 * math.pi / self.jacobi.other_quarter * u
        turn = -self._along * u
        out = np.empty(u.shape, dtype=np.complex128)
        out.real, out.imag = self._cos, self._sin * np.tanh(grown)
        big, small = np.exp(2.0 * grown), np.exp(-2.0 * grown)
        for g in self._nomes.tolist():
            if g < 1e-40:
                break
            up, down = g * big, g * small
            if float(up.max(initial=0.0)) < 1e-18 and float(down.max(initial=0.0)) < 1e-18:
                break
            out *= (1.0 + self._twice * up) * (1.0 + self._twice.conjugate() * down)
        out *= np.cos(turn) + 1j * np.sin(turn)
        return out

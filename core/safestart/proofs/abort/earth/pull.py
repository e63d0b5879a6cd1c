"""Gravity of a point mass and J2 along a course: bounds on a disc of complex times, series of it and of its gradient.

With x the course and s = x . x, and b = 3/2 mu J2 R^2,

    g = level x + gamma z e_z,     level = -mu s^(-3/2) - b (s^(-5/2) - 5 z^2 s^(-7/2)),   gamma = -2 b s^(-5/2),
    G = level + alpha x x' + beta (x e_z' + e_z x') + gamma e_z e_z',
    alpha = 3 mu s^(-5/2) + b (5 s^(-7/2) - 35 z^2 s^(-9/2)),   beta = 10 b z s^(-7/2).
"""

from __future__ import annotations

from dataclasses import dataclass
from operator import mul

from flint import arb, arb_mat, arb_poly

Series = list[arb]


@dataclass(frozen=True, slots=True)
class Field:
    """Gravity in scaled time: mu and 3/2 mu J2 R^2, m^3 and m^5."""

    mu: arb
    bulge: arb

    def pull(self, size: arb, square: arb) -> arb:
        """Bound on |g| where |r| <= size and |r . r| >= square, also for complex r."""
        q = size * size / square
        return self.mu * size / square.sqrt() ** 3 + self.bulge * size / square.sqrt() ** 5 * (3 + 5 * q)

    def slope(self, size: arb, square: arb) -> arb:
        """Bound |G|, the gradient of g, where :meth:`pull` bounds |g|."""
        q = size * size / square
        return (
            self.mu * (1 + 3 * q) / square.sqrt() ** 3
            + self.bulge * (3 + 30 * q + 35 * q * q) / square.sqrt() ** 5
        )


class Pull:
    """Series of gravity along a course, one coefficient after the other."""

    def __init__(self, field: Field) -> None:
        self.field = field
        self.xs: list[Series] = [[], [], []]
        self.square: Series = []
        self.rising: Series = []
        self.zz: Series = []
        self.powers = {power: _Power(power) for power in (3, 5, 7)}
        self.level: Series = []
        self.upright: Series = []

    def extended(self, r: list[arb_mat]) -> arb_mat:
        """Coefficient of g (3, 1) of the next order, from the course's up to it."""
        k = len(self.square)
        for x, entry in zip(self.xs, r[k].entries(), strict=True):
            x.append(entry)
        squares = [_squared(x, k) for x in self.xs]
        self.zz.append(squares[2])
        self.square.append(squares[0] + squares[1] + squares[2])
        self.rising.append(k * self.square[k])
        for power in self.powers.values():
            power.extend(self.square, self.rising)
        mu, b = self.field.mu, self.field.bulge
        a3, a5, a7 = (self.powers[p].series for p in (3, 5, 7))
        level = -mu * a3[k] - b * (a5[k] - 5 * _product(self.zz, a7, k))
        self.level.append(level)
        self.upright.append(level - 2 * b * a5[k])
        factors = (self.level, self.level, self.upright)
        return arb_mat(3, 1, [_product(f, x, k) for f, x in zip(factors, self.xs, strict=True)])

    def slopes(self) -> list[arb_mat]:
        """Coefficients of G (3, 3), as many as g has."""
        count = len(self.square)
        nine = _Power(9)
        for _ in range(count):
            nine.extend(self.square, self.rising)
        mu, b = self.field.mu, self.field.bulge
        a5, a7, a9, zz = (
            arb_poly(e) for e in (self.powers[5].series, self.powers[7].series, nine.series, self.zz)
        )
        xs = [arb_poly(x) for x in self.xs]
        alpha = 3 * mu * a5 + 5 * b * a7 - _cut(35 * b * (zz * a9), count)
        beta = _cut(10 * b * (xs[2] * a7), count)
        ax, bent = [_cut(alpha * x, count) for x in xs], [beta * x for x in xs]
        entries = [[ax[i] * xs[j] for j in range(3)] for i in range(3)]
        for i in range(3):
            entries[i][i] += arb_poly(self.level)
            entries[i][2] += bent[i]
            entries[2][i] += bent[i]
        entries[2][2] += -2 * b * a5
        flat = [_coefficients(e, count) for row in entries for e in row]
        return [arb_mat(3, 3, [e[k] for e in flat]) for k in range(count)]


class _Power:
    """Series of s^(-power/2), one coefficient after the other, from those of s and of its derivative times t: with
    s f' = -(power/2) s' f, k s_0 f_k = -sum over j of (power/2) j s_j f_(k-j) + s_j (k - j) f_(k-j)."""

    def __init__(self, power: int) -> None:
        self.power = power
        self.series: Series = []
        self.rising: Series = []

    def extend(self, square: Series, rising: Series) -> None:
        """Add the next coefficient."""
        k, f = len(self.series), self.series
        if k == 0:
            f.append(1 / square[0].sqrt() ** self.power)
        else:
            back, slopes = f[k - 1 :: -1], self.rising[k - 1 :: -1]
            sums = self.power * dot(rising[1 : k + 1], back) + 2 * dot(square[1 : k + 1], slopes)
            f.append(sums / (-2 * k * square[0]))
        self.rising.append(k * f[k])


def _cut(poly: arb_poly, count: int) -> arb_poly:
    return arb_poly(_coefficients(poly, count))


def _coefficients(poly: arb_poly, count: int) -> Series:
    """The first coefficients; a series may end early."""
    found = poly.coeffs()[:count]
    return [*found, *[arb(0)] * (count - len(found))]


def dot(a: Series, b: Series) -> arb:
    """Sum of products."""
    return sum(map(mul, a, b), arb(0))


def _product(a: Series, b: Series, k: int) -> arb:
    """Coefficient k of a product."""
    return dot(a[: k + 1], b[k::-1])


def _squared(a: Series, k: int) -> arb:
    """Coefficient k of a square."""
    half = (k + 1) // 2
    pairs = 2 * dot(a[:half], a[k : k - half : -1]) if half else arb(0)
    return pairs + a[k // 2] * a[k // 2] if k % 2 == 0 else pairs

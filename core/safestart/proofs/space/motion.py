"""The relative motion of one statement in ball arithmetic, by Taylor series of its equations.

    x'' = 2 w y' + w' y + (w^2 + 2 g) x + u_x,  y'' = -2 w x' - w' x + (w^2 - g) y + u_y,  z'' = -g z + u_z

with w = k^2 rho^2, w' = -2 k^2 e s rho w, g = k^4 rho^3 and rho = 1 + e c of :mod:`safestart.proofs.space.orbit`. For
complex times within the orbit's radius tau |v| is at most N = (a |r| + |v| + |u| tau) exp((a + 2 w) tau), with a^2 a
bound on the matrix of r, and |r| at most |r(0)| + tau N: so the coefficients are bounded (Cauchy).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from flint import arb, arb_mat, arb_poly, fmpq

from safestart.proofs.space.orbit import Orbit
from safestart.proofs.space.series import Series, picard, rest

_BITS = 110


class Stretch(NamedTuple):
    """Part of an interval: its begin after the interval's (s), its length, and series of position and velocity.

    ``flown`` holds x, y, z, vx, vy, vz of every column in turn.
    """

    begin: fmpq
    length: fmpq
    flown: list[Series]


class Motion:
    """The motion near a target on ``orbit``, in intervals of ``dt`` s."""

    def __init__(self, orbit: Orbit, dt: fmpq) -> None:
        self.orbit, self.dt = orbit, dt
        self._count = 1 if orbit.still else max(1, math.ceil(8.0 * float(arb(dt) / orbit.radius)))
        ratio = 0.0 if orbit.still else float(arb(dt) / self._count / orbit.radius)
        self._order = 4 if orbit.still else max(4, math.ceil(_BITS / -math.log2(ratio)))

    def over(self, k: int, columns: list[list[arb]], pushes: list[list[arb]]) -> list[Stretch]:
        """States over interval k from the states ``columns`` (6 each) under the thrusts ``pushes`` (3 each)."""
        out, part = [], self.dt / self._count
        for i in range(self._count):
            begin = part * i
            matrix = self._matrix(self.dt * k + begin, part)
            flown = [self._flown(matrix, *each, part) for each in zip(columns, pushes, strict=True)]
            out.append(Stretch(begin, part, flown))
            columns = [[p(arb(1)) for p in each] for each in flown]
        return out

    def _matrix(self, begin: fmpq, length: fmpq) -> Series:
        """2 w, w', w^2 + 2 g, w^2 - g and g over a piece."""
        orbit = self.orbit
        if orbit.circular:
            n, square = orbit.pace, orbit.pace**2
            values = (2 * n, arb(0), 3 * square, arb(0), square)
            return [arb_poly([value]) for value in values]
        z = orbit.series(begin, length)
        rho, w = 1 + orbit.e * z[0], orbit.rate(z)
        change, tide = -2 * orbit.pace * orbit.e * z[1] * rho * w, orbit.pace * rho * w
        return [2 * w, change, w * w + 2 * tide, w * w - tide, tide]

    def _flown(self, matrix: Series, state: list[arb], push: list[arb], length: fmpq) -> Series:
        twice, change, radial, along, across = matrix
        ux, uy, uz = push

        def rates(y: Series) -> Series:
            px, py, pz, vx, vy, vz = y
            return [
                vx,
                vy,
                vz,
                twice * vy + change * py + radial * px + ux,
                -twice * vx - change * px + along * py + uy,
                -across * pz + uz,
            ]

        found = picard(state, rates, arb(length), self._order)
        if self.orbit.still:
            return found
        size, ratio = self._size(state, push), arb(length) / self.orbit.radius
        r, v = (rest(each, ratio, self._order) for each in size)
        return [p + (r if i < 3 else v) for i, p in enumerate(found)]

    def _size(self, state: list[arb], push: list[arb]) -> tuple[arb, arb]:
        """Bounds on |r| and |v| for complex times up to the radius."""
        orbit = self.orbit
        r, v, u = (
            sum((e.abs_upper() ** 2 for e in each), arb(0)).sqrt() for each in (state[:3], state[3:], push)
        )
        a = (orbit.most**2 + 2 * orbit.tide + orbit.change).sqrt()
        fast = (a * r + v + u * orbit.radius) * ((a + 2 * orbit.most) * orbit.radius).exp()
        return r + orbit.radius * fast, fast


class Held:
    """Transition and held thrust of one interval, at any time in it."""

    def __init__(self, motion: Motion, k: int) -> None:
        unit = [[arb(int(i == j)) for i in range(6)] for j in range(6)]
        none = [arb(0)] * 6
        pushes = [[arb(0)] * 3] * 6 + [[arb(int(i == j)) for i in range(3)] for j in range(3)]
        self._parts = motion.over(k, [*unit, none, none, none], pushes)

    def at(self, s: fmpq) -> tuple[arb_mat, arb_mat]:
        """Phi (6, 6) and B (6, 3) from the interval's begin to s seconds later."""
        part = self._parts[-1]
        for candidate in self._parts:
            if s <= candidate.begin + candidate.length:
                part = candidate
                break
        x = arb((s - part.begin) / part.length)
        columns = [[p(x) for p in each] for each in part.flown]
        return (
            arb_mat(6, 6, [columns[j][i] for i in range(6) for j in range(6)]),
            arb_mat(6, 3, [columns[6 + j][i] for i in range(6) for j in range(3)]),
        )

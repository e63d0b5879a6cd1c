"""The target's Kepler orbit in ball arithmetic: c = cos nu and s = sin nu, c' = -w s, s' = w c, w = k^2 (1 + e c)^2.

z = exp(i nu) has the coefficients of a power series that those of y' = k^2 (1 + e y)^2 y, y = 1 at first, exceed; y is
at most 2 up to tau = log 2 / (k^2 (1 + 2 e)^2), so they are at most 2 tau^-k.
"""

from __future__ import annotations

from flint import arb, arb_poly, fmpq

from safestart.proofs.space.series import Series, picard, rest

_ORDER, _STEPS = 20, 16


class Orbit:
    """Of ``mean_motion`` (rad/s), ``eccentricity`` < 1 and ``true_anomaly`` (rad) at t = 0."""

    def __init__(self, mean_motion: fmpq, eccentricity: fmpq, true_anomaly: fmpq) -> None:
        self.n, self.e, self.circular = arb(mean_motion), arb(eccentricity), eccentricity == 0
        self.pace = self.n / (1 - self.e * self.e) ** (arb(3) / 2)
        self.still = mean_motion == 0
        anomaly = arb(true_anomaly)
        self.first = [anomaly.cos(), anomaly.sin()]
        near = 1 + 2 * self.e
        self.radius = arb(10) ** 9 if self.still else arb(2).log() / (self.pace * near * near)
        # Bounds for complex times up to the radius: on w, mu / r^3 and w'.
        self.most = self.pace * near * near
        self.tide = self.pace**2 * near**3
        self.change = 4 * self.pace * self.e * near * self.most
        reach = self.radius / _STEPS
        self._reach = fmpq(int(float(reach.lower()) * 1e3), 1000)
        self._known: list[list[arb]] = [self.first]

    def at(self, time: fmpq) -> list[arb]:
        """cos nu and sin nu."""
        if self.circular:
            turned = self.n * arb(time)
            c, s = turned.cos(), turned.sin()
            return [self.first[0] * c - self.first[1] * s, self.first[1] * c + self.first[0] * s]
        index = int((time / self._reach).floor())
        while len(self._known) <= index:
            self._known.append([p(arb(1)) for p in self._over(self._known[-1], self._reach)])
        left = time - self._reach * index
        return [p(arb(1)) for p in self._over(self._known[index], left)] if left > 0 else self._known[index]

    def series(self, begin: fmpq, length: fmpq) -> Series:
        """cos nu and sin nu over a piece of at most ``radius`` / 16 s."""
        return self._over(self.at(begin), length)

    def _over(self, start: list[arb], length: fmpq) -> Series:
        found = picard(start, self._rates, arb(length), _ORDER)
        beyond = arb(0) if self.still else rest(arb(2), arb(length) / self.radius, _ORDER)
        return [p + beyond for p in found]

    def _rates(self, z: Series) -> Series:
        w = self.rate(z)
        return [-w * z[1], w * z[0]]

    def rate(self, z: Series) -> arb_poly:
        """w of (c, s)."""
        if self.circular:
            return arb_poly([self.pace])
        rho = 1 + self.e * z[0]
        return self.pace * rho * rho

    def rate_at(self, time: fmpq) -> arb:
        """w, rad/s."""
        if self.circular:
            return self.pace
        rho = 1 + self.e * self.at(time)[0]
        return self.pace * rho * rho

    def turn(self, begin: fmpq, length: fmpq) -> Series:
        """cos and sin of nu(t) - nu(0), by which LVLH has turned since t = 0, over a piece."""
        c, s = self.series(begin, length)
        c0, s0 = self.first
        return [c0 * c + s0 * s, c0 * s - s0 * c]

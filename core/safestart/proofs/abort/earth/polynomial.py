"""A polynomial with matrices as coefficients, at one time in ball arithmetic."""

from __future__ import annotations

from flint import arb, arb_mat

_NARROW = arb(2) ** -80
"""Radius of a ball that counts as one time: there the sum of all powers is one product of matrices, and as good."""


class Polynomial:
    """Matrices as coefficients of powers of a scaled time."""

    def __init__(self, coefficients: list[arb_mat]) -> None:
        self.coefficients = coefficients
        self._beside: arb_mat | None = None

    def at(self, time: arb) -> tuple[arb_mat, arb_mat]:
        """Value and derivative."""
        first = self.coefficients[0]
        if not arb(time.rad()) < _NARROW:
            # Over a wide ball of times Horner's scheme has the narrower result.
            return self._over(time)
        if self._beside is None:
            entries = zip(*(m.entries() for m in self.coefficients), strict=True)
            self._beside = arb_mat([list(series) for series in entries])
        power, powers = arb(1), []
        for k in range(1, len(self.coefficients) + 1):
            powers += [power, k * power]
            power = power * time
        rates = [arb(0), *powers[1::2][:-1]]
        found = self._beside * arb_mat(
            len(rates), 2, [e for both in zip(powers[::2], rates, strict=True) for e in both]
        )
        value, rate = zip(*found.tolist(), strict=True)
        shape = first.nrows(), first.ncols()
        return arb_mat(*shape, list(value)), arb_mat(*shape, list(rate))

    def _over(self, time: arb) -> tuple[arb_mat, arb_mat]:
        last = len(self.coefficients) - 1
        value, rate = self.coefficients[last], last * self.coefficients[last]
        for k in range(last - 1, -1, -1):
            value = value * time + self.coefficients[k]
            if k:
                rate = rate * time + k * self.coefficients[k]
        return value, rate

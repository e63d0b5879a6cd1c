"""A set of thrusts cut by half-spaces through 0, another one in every interval: {w in W: g_k . w <= 0}."""

from __future__ import annotations

import numpy as np

from safestart.model.scenario import Floats
from safestart.optim.cone_program import ConeProgram
from safestart.optim.thrust_shapes import UnitSet

_GOLDEN, _NARROWINGS = 0.6180339887498949, 70


class CutSet:
    """``whole`` with the cuts g (N, channels) of its intervals; 0 leaves an interval whole."""

    def __init__(self, whole: UnitSet, cuts: Floats) -> None:
        self.whole, self.cuts = whole, cuts

    def keep(self, program: ConeProgram, count: int, channels: int) -> None:
        """See :class:`~safestart.optim.thrust_shapes.UnitSet`."""
        self.whole.keep(program, count, channels)
        held = np.nonzero(self.cuts[:count].any(axis=1))[0]
        if len(held):
            rows = np.zeros((len(held), count, channels))
            rows[np.arange(len(held)), held] = -self.cuts[held]
            program.rows("cuts", np.zeros(len(held)), thrust=rows.reshape(len(held), -1))

    def repaired(self, w: Floats) -> Floats:
        """Points (N, channels) in the set: components beyond the cut are scaled down, which leaves no whole set."""
        inside = self.whole.repaired(w)
        shares = self.cuts[: len(inside)] * inside
        over, under = np.maximum(shares, 0.0).sum(axis=1), np.maximum(-shares, 0.0).sum(axis=1)
        kept = np.divide(under, over, out=np.ones(len(inside)), where=over > under)
        out: Floats = np.where(shares > 0.0, kept[:, None] * inside, inside)
        return out

    def support(self, pulls: Floats) -> Floats:
        """The support of the whole set, which is not smaller."""
        return self.whole.support(pulls)

    def bound(self, constant: Floats, rows: Floats, weights: Floats, scale: float, channels: int) -> float:
        """Largest weighted sum of the rows (m): max pull . w over the cut set = min over l >= 0 of h_W(pull - l g).

        Any l bounds it; a golden section narrows it down.
        """
        pull = (weights @ rows).reshape(-1, channels)
        cuts = self.cuts[: len(pull)]

        def reach(share: Floats) -> Floats:
            return self.whole.support((pull - share[:, None] * cuts)[:, None, :])

        size = np.abs(cuts)
        least = np.where(size > 1e-9 * size.max(axis=1, keepdims=True), size, np.inf).min(axis=1)
        held = np.isfinite(least)
        high = np.divide(np.abs(pull).max(axis=1), least, out=np.zeros(len(pull)), where=held)
        low, found = np.zeros(len(pull)), reach(np.zeros(len(pull)))
        for _ in range(_NARROWINGS if held.any() else 0):
            a, b = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
            at_a, at_b = reach(a), reach(b)
            left = at_a <= at_b
            high, low = np.where(left, b, high), np.where(left, low, a)
            found = np.minimum(found, np.minimum(at_a, at_b))
        return float(weights @ constant + scale * found.sum())

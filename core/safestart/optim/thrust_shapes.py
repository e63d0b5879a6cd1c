"""Unit sets of thrusts, one point of which is chosen in every interval: ball, cube, simplex.

A thrust is a linear map of the point: a ball's radius times it, a box's half-widths times it, or the sum of thrusters
weighted by it. A program has the points as its variable ``thrust``, ordered by interval, then channel.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Protocol

import numpy as np

from safestart.model.scenario import Floats
from safestart.optim.cone_program import ConeProgram, Each
from safestart.optim.thrust_ball import INSIDE, bound, into_balls, keep_in_balls


class UnitSet(Protocol):
    """The set of admissible points w (channels,)."""

    def keep(self, program: ConeProgram, count: int, channels: int) -> None:
        """Blocks of the program that keep ``count`` points in the set."""
        ...

    def repaired(self, w: Floats) -> Floats:
        """Points (N, channels); those slightly outside are moved back in."""
        ...

    def support(self, pulls: Floats) -> Floats:
        """Largest pull . w over the set, summed over the intervals: pulls (..., N, channels), (...)."""
        ...

    def bound(self, constant: Floats, rows: Floats, weights: Floats, scale: float, channels: int) -> float:
        """Largest weighted sum of the rows (m) over all histories of ``scale`` times points."""
        ...


class Ball:
    """|w| <= 1."""

    def keep(self, program: ConeProgram, count: int, channels: int) -> None:
        """See :class:`UnitSet`."""
        keep_in_balls(program, count, channels)

    def repaired(self, w: Floats) -> Floats:
        """See :class:`UnitSet`."""
        return into_balls(w)

    def support(self, pulls: Floats) -> Floats:
        """See :class:`UnitSet`."""
        out: Floats = np.sqrt(np.square(pulls).sum(axis=-1)).sum(axis=-1)
        return out

    def bound(self, constant: Floats, rows: Floats, weights: Floats, scale: float, channels: int) -> float:
        """See :class:`UnitSet`."""
        return bound(constant, rows, weights, scale, channels)


class _Polytope(ABC):
    @abstractmethod
    def support(self, pulls: Floats) -> Floats:
        """See :class:`UnitSet`."""

    def bound(self, constant: Floats, rows: Floats, weights: Floats, scale: float, channels: int) -> float:
        """See :class:`UnitSet`."""
        pull = (weights @ rows).reshape(-1, channels)
        return float(weights @ constant + scale * self.support(pull))


class Cube(_Polytope):
    """|w_i| <= 1 for every channel."""

    def keep(self, program: ConeProgram, count: int, channels: int) -> None:
        """See :class:`UnitSet`."""
        rows = np.arange(count * channels)[:, None]
        program.rows("below", np.ones(count * channels), thrust=Each(rows, -1.0))
        program.rows("above", np.ones(count * channels), thrust=Each(rows))

    def repaired(self, w: Floats) -> Floats:
        """See :class:`UnitSet`."""
        return np.clip(w, -1.0, 1.0)

    def support(self, pulls: Floats) -> Floats:
        """See :class:`UnitSet`."""
        out: Floats = np.abs(pulls).sum(axis=(-2, -1))
        return out


class Simplex(_Polytope):
    """w_i >= 0 with sum at most 1."""

    def keep(self, program: ConeProgram, count: int, channels: int) -> None:
        """See :class:`UnitSet`."""
        rows = np.arange(count * channels)[:, None]
        program.rows("positive", np.zeros(count * channels), thrust=Each(rows))
        program.rows("together", np.ones(count), thrust=Each(rows // channels, -1.0))

    def repaired(self, w: Floats) -> Floats:
        """See :class:`UnitSet`."""
        positive = np.maximum(w, 0.0)
        out: Floats = positive * (INSIDE / np.maximum(positive.sum(axis=1), INSIDE))[:, None]
        return out

    def support(self, pulls: Floats) -> Floats:
        """See :class:`UnitSet`."""
        out: Floats = np.maximum(pulls.max(axis=-1), 0.0).sum(axis=-1)
        return out


BALL, CUBE, SIMPLEX = Ball(), Cube(), Simplex()

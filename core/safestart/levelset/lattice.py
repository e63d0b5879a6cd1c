"""The grid of a level-set problem: a box of states, node counts, and the boundary of each axis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from safestart.errors import invalid
from safestart.model.scenario import Floats

MIN_NODES, MAX_NODES, MAX_AXES = 5, 2000, 6
MAX_TOTAL_NODES = 200_000_000


class Boundary(StrEnum):
    """The value that a stencil sees beyond the last node of an axis.

    ``EDGE`` repeats the last value: without a slope across the wall nothing flows in from outside, and the first-order
    scheme keeps the range of the initial values. The extrapolations continue the slope (``AWAY_FROM_ZERO`` with the
    sign that moves it away from zero, the default of hj-reachability); inflow feeds on them without bound.
    """

    EDGE = "edge"
    PERIODIC = "periodic"
    EXTRAPOLATE = "extrapolate"
    AWAY_FROM_ZERO = "extrapolate_away_from_zero"


@dataclass(frozen=True, slots=True)
class Lattice:
    """Nodes over the box ``low`` to ``high`` (n,), ``shape`` of them, 2 to 6 axes.

    A periodic axis (an angle) ends one spacing before ``high``, where it begins again. Units are the state's own.
    Raises ``InvalidInput`` for an empty box, too few nodes or more than memory will hold.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    shape: tuple[int, ...]
    boundary: tuple[Boundary, ...]

    @classmethod
    def of(
        cls,
        low: Sequence[float] | Floats,
        high: Sequence[float] | Floats,
        shape: Sequence[int],
        boundary: Boundary | str | Sequence[Boundary | str] = Boundary.EDGE,
    ) -> Lattice:
        """Lattice with one boundary for all axes, or one each."""
        n = len(shape)
        each = [boundary] * n if isinstance(boundary, str) else list(boundary)
        return cls(
            tuple(float(x) for x in low),
            tuple(float(x) for x in high),
            tuple(int(k) for k in shape),
            tuple(Boundary(b) for b in each),
        )

    def __post_init__(self) -> None:
        n = len(self.shape)
        if not 2 <= n <= MAX_AXES or not len(self.low) == len(self.high) == len(self.boundary) == n:
            sizes = [len(self.low), len(self.high), n, len(self.boundary)]
            raise invalid("lattice", f"low, high, shape and boundary of equal length, 2 to {MAX_AXES}", sizes)
        for low, high in zip(self.low, self.high, strict=True):
            if not (math.isfinite(low) and math.isfinite(high) and low < high):
                raise invalid("lattice", "finite low < high on every axis", (low, high))
        if (
            not all(MIN_NODES <= k <= MAX_NODES for k in self.shape)
            or math.prod(self.shape) > MAX_TOTAL_NODES
        ):
            raise invalid(
                "lattice.shape",
                f"{MIN_NODES} to {MAX_NODES} nodes per axis, at most {MAX_TOTAL_NODES} in all",
                self.shape,
            )

    @property
    def ndim(self) -> int:
        """Number of axes n."""
        return len(self.shape)

    @property
    def spacing(self) -> Floats:
        """Distance between nodes by axis, (n,)."""
        gaps = [
            k if b is Boundary.PERIODIC else k - 1 for k, b in zip(self.shape, self.boundary, strict=True)
        ]
        widths: Floats = np.array(self.high) - np.array(self.low)
        return widths / np.array(gaps, dtype=np.float64)

    @property
    def axes(self) -> list[Floats]:
        """Node coordinates of every axis."""
        return [
            np.linspace(low, high, k, endpoint=b is not Boundary.PERIODIC)
            for low, high, k, b in zip(self.low, self.high, self.shape, self.boundary, strict=True)
        ]

    def coordinates(self) -> list[Floats]:
        """The axes as arrays that broadcast against the grid: axis i has shape (1, .., k_i, .., 1)."""
        return list(np.meshgrid(*self.axes, indexing="ij", sparse=True))

"""A plane through the states at t = 0: two coordinates that move a start, everything else fixed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.errors import invalid
from safestart.model.scenario import Floats

LEAST_SPAN, MOST_SPAN = 1e-3, 1e5


@dataclass(frozen=True, slots=True)
class Plane:
    """Starts ``origin`` + ``columns`` @ (a, b): LVLH states (6,) in m and m/s, columns (6, 2) per unit of a and b.

    ``low`` and ``high`` (2,) bound a and b. Raises ``InvalidInput`` where the columns are not independent.
    """

    origin: Floats
    columns: Floats
    low: Floats
    high: Floats

    def __post_init__(self) -> None:
        if not (np.isfinite(self.origin).all() and np.isfinite(self.columns).all()):
            raise invalid("plane", "finite numbers", "others")
        span = self.high - self.low
        if not ((span >= LEAST_SPAN) & (span <= MOST_SPAN)).all():
            raise invalid("low", f"less than high by {LEAST_SPAN:g} to {MOST_SPAN:g}", self.low)
        if np.linalg.matrix_rank(self.columns / np.linalg.norm(self.columns, axis=0), 1e-6) < 2:
            raise invalid("direction", "two directions that differ", self.columns.T)

    def states(self, points: Floats) -> Floats:
        """LVLH starts (..., 6) of points (..., 2)."""
        out: Floats = self.origin + points @ self.columns.T
        return out

    def grid(self, across: int, along: int) -> tuple[Floats, Floats, Floats]:
        """Values of a (across,), of b (along,), and the points (along, across, 2)."""
        a = np.linspace(self.low[0], self.high[0], across)
        b = np.linspace(self.low[1], self.high[1], along)
        return a, b, np.stack(np.meshgrid(a, b), axis=-1)

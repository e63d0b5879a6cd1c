"""Periods of an encounter, and the remaining time of the game in each."""

from __future__ import annotations

import math
from dataclasses import dataclass

from safestart.errors import invalid


@dataclass(frozen=True, slots=True)
class Clock:
    """``duration_s`` in steps of one control period of ``period_s``; commands and pushes are held for a period.

    ``receding`` keeps the whole horizon ahead at every step (a supervisor on watch); otherwise the time to go runs down
    and the game ends with the horizon (the game of the value function).
    """

    period_s: float
    duration_s: float
    receding: bool = False

    def __post_init__(self) -> None:
        if not 0.0 < self.period_s <= self.duration_s < math.inf:
            raise invalid("period_s", "0 < period_s <= duration_s", (self.period_s, self.duration_s))

    @property
    def steps(self) -> int:
        """Whole periods."""
        return math.floor(self.duration_s / self.period_s + 1e-9)

    def to_go(self, step: int, horizon_s: float) -> float:
        """Remaining seconds of the game at the start of a step."""
        return horizon_s if self.receding else max(horizon_s - step * self.period_s, 0.0)

"""The exact question; face distances are affine functions of the start and the thrust history.

Question `stay`: does any thrust history, held over intervals of dt and of norm at most a_max, keep the chaser in the
rotating corridor at ALL times of [0, T]? The corridor is polyhedral at every instant and CWH is linear, so for a
start x0 and thrusts u the distance to face i at time t, slack / |A_i| in metres, is

    f_i(t) = offset_i + start_i(t) . x0 + sum_k thrust_ik(t) . u_k.
"""

from __future__ import annotations

from dataclasses import dataclass

from safestart.errors import invalid
from safestart.scenario import Scenario, number

MAX_STEPS = 400
MAX_TIME = 3600.0


@dataclass(frozen=True, slots=True)
class Question:
    """Horizon of ``steps`` intervals of ``dt`` seconds; ``dimensions`` 2 (in the orbit plane) or 3."""

    scenario: Scenario
    dt: float = 2.0
    steps: int = 30
    dimensions: int = 2

    def __post_init__(self) -> None:
        number("dt", self.dt, 0.0, MAX_TIME, open_low=True)
        if (
            isinstance(self.steps, bool)
            or not isinstance(self.steps, int)
            or not 1 <= self.steps <= MAX_STEPS
        ):
            raise invalid("steps", f"an integer in [1, {MAX_STEPS}]", self.steps)
        number("horizon", self.steps * self.dt, 0.0, MAX_TIME, open_low=True)
        if self.dimensions not in (2, 3):
            raise invalid("dimensions", "2 or 3", self.dimensions)

    @property
    def horizon(self) -> float:
        """T in seconds."""
        return self.steps * self.dt

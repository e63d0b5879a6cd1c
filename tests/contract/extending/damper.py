"""An example controller: thrust against the velocity."""

from __future__ import annotations

from typing import Any

import numpy as np

from safestart.control.controller import Command
from safestart.model.scenario import Floats, Scenario


class Damper:
    """Brakes with a fifth of the speed per second, as far as ``limit`` m/s^2 allows."""

    def __init__(self, limit: float) -> None:
        self.limit = limit

    def begin(self, state: Floats) -> None:
        """Nothing to forget."""

    def command(self, k: int, state: Floats) -> Command:
        """Thrust of the interval."""
        wanted = -0.2 * state[3:]
        size = float(np.linalg.norm(wanted))
        return Command(wanted * min(1.0, self.limit / max(size, 1e-12)), size <= self.limit, "damp")


def for_sweep(_: Any, scenario: Scenario, dt: float, steps: int, nodes: int) -> Damper:
    """The damper of a sweep's scenario."""
    return Damper(scenario.chaser.max_acceleration)

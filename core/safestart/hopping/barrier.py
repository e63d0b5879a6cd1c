"""The barrier of the hopping MPC: what the chaser does if it is never pushed again must keep out of a sphere.

Rows (29j), h' + alpha h >= 0 with h = |p|^2 - R^2, over the drift of the next two orbits on a fine grid. They are
quadratic in the state, so they are linearised in the present impulse, and the true rows are looked at again. The
tightened barrier takes R + kappa sigma for R, sigma the standard deviation of the drift along the line of sight.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safestart.dynamics.cwh import transition_matrix
from safestart.model.scenario import Floats

GRID = 480
_WORST = 60


@dataclass(frozen=True, slots=True)
class Noise:
    """Standard deviations: navigation position (m) and velocity (m/s) per axis, thrust size, thrust direction (rad)."""

    position: float = 0.0
    velocity: float = 0.0
    share: float = 0.0
    angle: float = 0.0


class Barrier:
    """Rows of the unforced drift from a state, ``keep_out`` m around the target."""

    def __init__(
        self, mean_motion: float, keep_out: float, kappa: float, noise: Noise, orbits: float = 2.0
    ) -> None:
        times = orbits * math.tau / mean_motion * np.arange(1, GRID + 1) / GRID
        self.phi = np.array([transition_matrix(mean_motion, float(t)) for t in times])
        self.keep_out, self.kappa, self.noise = keep_out, kappa, noise
        # From alpha >= 3 n on, hops of the R-bar as planned keep the rows.
        self.alpha = 3.0 * mean_motion

    def rows(self, state: Floats, impulse: Floats) -> tuple[Floats, Floats]:
        """Values (GRID,) of the rows, in m, and their slopes (GRID, 3) in the impulse; ``state`` (6,) before it."""
        after = state.copy()
        after[3:] += impulse
        there = self.phi @ after
        p, v = there[:, :3], there[:, 3:]
        by_p, by_v = self.phi[:, :3, 3:], self.phi[:, 3:, 3:]
        distance = np.linalg.norm(p, axis=1)
        radius = self.keep_out + self.kappa * self._spread(p / np.maximum(distance, 1e-9)[:, None], impulse)
        scale = 2.0 * self.alpha * self.keep_out
        value = (2.0 * (p * v).sum(axis=1) + self.alpha * (distance**2 - radius**2)) / scale
        slope = 2.0 * np.einsum("ti,tij->tj", v + self.alpha * p, by_p) + 2.0 * np.einsum(
            "ti,tij->tj", p, by_v
        )
        return value, slope / scale

    def worst(self, values: Floats) -> NDArray[np.int64]:
        """Which rows to ask for: those with the least values."""
        return np.argsort(values)[:_WORST].astype(np.int64)

    def _spread(self, sight: Floats, impulse: Floats) -> Floats:
        """Standard deviation (GRID,) of the drift along the line of sight (GRID, 3)."""
        q = np.einsum("ti,tij->tj", sight, self.phi[:, :3, :])
        noise = self.noise
        size = float(impulse @ impulse)
        ahead = (q[:, 3:] @ impulse) ** 2
        across = size * (q[:, 3:] ** 2).sum(axis=1) - ahead
        variance = (
            noise.position**2 * (q[:, :3] ** 2).sum(axis=1)
            + noise.velocity**2 * (q[:, 3:] ** 2).sum(axis=1)
            + noise.share**2 * ahead
            + noise.angle**2 * np.maximum(across, 0.0)
        )
        spread: Floats = np.sqrt(variance)
        return spread

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
from safestart.hopping.barrier_kernel import barrier_rows
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
        self.sigmas = np.array([noise.position, noise.velocity, noise.share, noise.angle])

    def rows(self, state: Floats, impulse: Floats) -> tuple[Floats, Floats]:
        """Values (GRID,) of the rows, in m, and their slopes (GRID, 3) in the impulse; ``state`` (6,) before it."""
        values, slopes = np.empty(len(self.phi)), np.empty((len(self.phi), 3))
        barrier_rows(
            self.phi,
            np.ascontiguousarray(state),
            np.ascontiguousarray(impulse),
            self.keep_out,
            self.kappa,
            self.alpha,
            self.sigmas,
            values,
            slopes,
        )
        return values, slopes

    def worst(self, values: Floats) -> NDArray[np.int64]:
        """Which rows to ask for: those with the least values."""
        return np.argsort(values)[:_WORST].astype(np.int64)

"""The accelerations of CWH written straight from paper 000, eq. (1), as the tests need them."""

import numpy as np

from safestart.model.scenario import Floats


def feedforward(mean_motion: float, position: Floats, velocity: Floats) -> Floats:
    """Acceleration that cancels the CWH terms, shape (..., 3) (eq. 6)."""
    n = mean_motion
    x, z = position[..., 0], position[..., 2]
    vx, vy = velocity[..., 0], velocity[..., 1]
    return np.stack([-(3.0 * n * n * x + 2.0 * n * vy), 2.0 * n * vx, n * n * z], axis=-1)

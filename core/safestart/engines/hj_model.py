"""The body-frame motion as hj-reachability wants it: time-invariant, affine in a disk of thrust.

With J the +90 degree rotation and w = omega_t, CWH (paper 000, eq. 1) seen from the rotating body frame is

    dv/dt = -2 (w + n) J v + (w^2 + 2 n w + 1.5 n^2) p + 1.5 n^2 Q(2 w t) p + u,
    Q(a) = [[cos a, -sin a], [-sin a, -cos a]].

The last gravity-gradient term turns at 2 w and would make the problem time-varying. It is dropped here; its
size is 1.5 n^2 |p|, 5e-4 m/s^2 at 272 m on a low orbit.
"""

from __future__ import annotations

from typing import Any

import hj_reachability as hj
import jax.numpy as jnp
import numpy as np

from safestart.scenario import Floats, Target

DROPPED_TERM = "gravity-gradient part 1.5 n^2 Q(2 omega_t t) p, which turns at twice the tumble rate"


def coefficients(target: Target) -> tuple[float, float]:
    """(2 (w + n), w^2 + 2 n w + 1.5 n^2) in 1/s and 1/s^2: the turning and the centrifugal coefficient."""
    w, n = target.tumble_rate, target.mean_motion
    return 2.0 * (w + n), w * w + 2.0 * n * w + 1.5 * n * n


def system_matrix(target: Target) -> Floats:
    """A (4, 4) of the body-frame state (x, y, vx, vy); the input matrix is [0; I]."""
    turn, push = coefficients(target)
    a = np.zeros((4, 4))
    a[0, 2] = a[1, 3] = 1.0
    a[2, 0] = a[3, 1] = push
    a[2, 3], a[3, 2] = turn, -turn
    return a


def rotating_gradient(target: Target, time: float) -> Floats:
    """The dropped 1.5 n^2 Q(2 w t), shape (2, 2), in 1/s^2."""
    angle, n = 2.0 * target.tumble_rate * time, target.mean_motion
    c, s = np.cos(angle), np.sin(angle)
    return 1.5 * n * n * np.array([[c, -s], [-s, -c]])


class BodyFrame(hj.ControlAndDisturbanceAffineDynamics):  # type: ignore[misc]
    """Dynamics for the solver: thrust minimises the value, the disturbance is a box of zero size.

    ``turn``, ``push`` (see :func:`coefficients`) and ``a_max`` may be traced by JAX, so that one compiled
    program serves every tumble rate and thrust.
    """

    def __init__(self, turn: Any, push: Any, a_max: Any) -> None:
        self.turn, self.push = turn, push
        nothing = hj.sets.Box(jnp.zeros(1), jnp.zeros(1))
        super().__init__("min", "max", hj.sets.Ball(jnp.zeros(2), a_max), nothing)

    def open_loop_dynamics(self, state: Any, time: Any) -> Any:
        """Drift dx/dt (4,) without thrust."""
        del time
        x, y, vx, vy = state
        return jnp.stack([vx, vy, self.turn * vy + self.push * x, -self.turn * vx + self.push * y])

    def control_jacobian(self, state: Any, time: Any) -> Any:
        """Thrust enters the two velocities, (4, 2)."""
        del state, time
        return jnp.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])

    def disturbance_jacobian(self, state: Any, time: Any) -> Any:
        """No disturbance, (4, 1); the interface wants one."""
        del state, time
        return jnp.zeros((4, 1))

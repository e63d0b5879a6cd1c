"""The motion in hj-reachability's form: time-invariant, affine in a disk of thrust."""

from __future__ import annotations

from typing import Any

import hj_reachability as hj
import jax.numpy as jnp


class LinearMotion(hj.ControlAndDisturbanceAffineDynamics):  # type: ignore[misc]
    """Dynamics of either frame: thrust minimises the value, the disturbance is a box of zero size.

    ``turn``, ``gx``, ``gy`` (see :class:`safestart.engines.hj.frame.Coefficients`) and ``a_max`` may be traced
    by JAX, so that one compiled program serves every tumble rate, frame and thrust.
    """

    def __init__(self, turn: Any, gx: Any, gy: Any, a_max: Any) -> None:
        self.turn, self.gx, self.gy = turn, gx, gy
        nothing = hj.sets.Box(jnp.zeros(1), jnp.zeros(1))
        super().__init__("min", "max", hj.sets.Ball(jnp.zeros(2), a_max), nothing)

    def open_loop_dynamics(self, state: Any, time: Any) -> Any:
        """Drift dx/dt (4,) without thrust."""
        del time
        x, y, vx, vy = state
        return jnp.stack([vx, vy, self.turn * vy + self.gx * x, -self.turn * vx + self.gy * y])

    def control_jacobian(self, state: Any, time: Any) -> Any:
        """Thrust enters the two velocities, (4, 2)."""
        del state, time
        return jnp.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])

    def disturbance_jacobian(self, state: Any, time: Any) -> Any:
        """No disturbance, (4, 1); the interface requires one."""
        del state, time
        return jnp.zeros((4, 1))

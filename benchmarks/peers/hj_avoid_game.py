"""The avoid game as a user of hj-reachability would write it: its model, its time loop, its default boundary."""

from __future__ import annotations

from typing import Any

import hj_reachability as hj
import jax.numpy as jnp
import numpy as np

from safestart.collision_avoidance.game import Game
from safestart.model.scenario import Floats


class AvoidGame(hj.ControlAndDisturbanceAffineDynamics):
    """Eq. (5) in the plane with boxes: Player 1 raises the value, Player 2 lowers it."""

    def __init__(self, game: Game) -> None:
        self.w = game.mean_motion
        u, d = jnp.array(game.control.bound), jnp.array(game.disturbance.bound)
        super().__init__("max", "min", hj.sets.Box(-u, u), hj.sets.Box(-d, d))

    def open_loop_dynamics(self, state: Any, time: Any) -> Any:
        """Drift (4,)."""
        del time
        _, y, vx, vy = state
        return jnp.array([vx, vy, -2.0 * self.w * vy, 2.0 * self.w * vx + 3.0 * self.w**2 * y])

    def control_jacobian(self, state: Any, time: Any) -> Any:
        """Accelerations (4, 2)."""
        del state, time
        return jnp.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])

    disturbance_jacobian = control_jacobian


def peer_tube(
    game: Game, horizon: float, half: tuple[float, float], shape: tuple[int, int], accuracy: str
) -> Floats:
    """Value (x, y, vx, vy) of the tube at the horizon, metres, float32 as the library computes."""
    ends = jnp.array([half[0], half[0], half[1], half[1]])
    grid = hj.Grid.from_lattice_parameters_and_boundary_conditions(
        hj.sets.Box(-ends, ends), (shape[0], shape[0], shape[1], shape[1])
    )
    target = jnp.linalg.norm(grid.states[..., :2], axis=-1) - game.keep_out_m
    settings = hj.SolverSettings.with_accuracy(
        accuracy, hamiltonian_postprocessor=hj.solver.backwards_reachable_tube
    )
    found = hj.step(settings, AvoidGame(game), grid, 0.0, target, -horizon, progress_bar=False)
    return np.asarray(found, dtype=np.float64)

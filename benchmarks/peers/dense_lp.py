"""The exact question as one dense linear program, the usual way: 16 directions for the disk, four checks per step.

The thrust polygon is inside the disk (its corners on the circle) or, with ``outer``, around it: the two bracket it.
The corridor is asked for at samples only, so the margin is optimistic in time. Solved by HiGHS, built once per question
and start; it shares the scalar closed forms of CWH with ours, and nothing of the cutting planes.
"""

from __future__ import annotations

import math

import highspy
import numpy as np

from safestart.attitude.body_frame import rotation
from safestart.constraints.corridor import corridor_of
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.model.scenario import Floats, Scenario

SIDES, CHECKS = 16, 4


class DenseLP:
    """Largest margin (m) that a planar start can hold at every check, with thrust in a polygon."""

    def __init__(self, scenario: Scenario, dt: float = 2.0, steps: int = 30, *, outer: bool = False) -> None:
        target, a_max = scenario.target, scenario.chaser.max_acceleration
        corridor = corridor_of(scenario.corridor)
        n = target.mean_motion
        state, drive = np.eye(4), np.zeros((4, 2 * steps))
        blocks, self.free = [], []
        offsets = corridor.offsets / corridor.lengths
        for k in range(steps):
            for part in range(1, CHECKS + 1):
                tau = dt * part / CHECKS
                phi, gain = planar_transition(n, tau), planar_input(n, tau)
                turned = (
                    corridor.normals
                    / corridor.lengths[:, None]
                    @ rotation(-target.tumble_rate * (k * dt + tau))
                )
                reach = phi @ drive
                reach[:, 2 * k : 2 * k + 2] += gain
                blocks.append(np.column_stack([turned @ reach[:2], np.ones(len(turned))]))
                self.free.append(turned @ (phi @ state)[:2])
            state, drive = phi @ state, reach
        angles = 2.0 * math.pi * np.arange(SIDES) / SIDES
        sides = np.kron(np.eye(steps), np.column_stack([np.cos(angles), np.sin(angles)]))
        self.reach = a_max if outer else a_max * math.cos(math.pi / SIDES)
        self.offsets = np.tile(offsets, CHECKS * steps)
        self.start = corridor.normals / corridor.lengths[:, None], offsets
        self.drift = np.vstack(self.free)
        self.model = self._model(np.vstack(blocks), sides)

    def _model(self, faces: Floats, sides: Floats) -> highspy.HighsLp:
        rows = np.vstack([faces, np.column_stack([sides, np.zeros(len(sides))])])
        model = highspy.HighsLp()
        count, columns = rows.shape
        model.num_col_, model.num_row_ = columns, count
        model.col_cost_ = np.append(np.zeros(columns - 1), -1.0)
        model.col_lower_ = np.full(columns, -highspy.kHighsInf)
        model.col_upper_ = np.full(columns, highspy.kHighsInf)
        model.row_lower_ = np.full(count, -highspy.kHighsInf)
        mask = rows != 0.0
        model.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
        model.a_matrix_.start_ = np.concatenate([[0], np.cumsum(mask.sum(axis=1))])
        model.a_matrix_.index_ = np.nonzero(mask)[1]
        model.a_matrix_.value_ = rows[mask]
        self.thrust_bounds = np.full(len(sides), self.reach)
        return model

    def margin(self, state: Floats) -> float:
        """Margin (m) of one start (x, y, vx, vy)."""
        normals, offsets = self.start
        self.model.row_upper_ = np.concatenate([self.offsets - self.drift @ state, self.thrust_bounds])
        # The start itself is a check, too; it bounds the margin and no thrust changes it.
        self.model.col_upper_ = np.append(
            np.full(self.model.num_col_ - 1, highspy.kHighsInf), float((offsets - normals @ state[:2]).min())
        )
        solver = highspy.Highs()
        solver.setOptionValue("output_flag", False)
        solver.setOptionValue("threads", 1)
        solver.passModel(self.model)
        solver.run()
        if solver.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            raise RuntimeError(f"HiGHS stopped with {solver.getModelStatus()}")
        return -float(solver.getInfo().objective_function_value)

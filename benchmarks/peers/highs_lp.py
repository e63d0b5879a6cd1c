"""The backward set of one cell as a linear program (paper 000, section 7), solved by HiGHS.

Variables: the inputs u_0..u_{N-1}, boxed, and one slack s, maximised subject to
A_c R(-theta_N) (A^N x_0 + sum_k A^(N-1-k) B u_k)_r + s |A_c| <= b_c. The start is in the set iff s >= 0.
The program is built once and only its right-hand side changes from cell to cell. By default every cell is
solved from scratch, as the paper does; with ``hot`` each solve starts from the last cell's basis, the
strongest form of this peer.
"""

from __future__ import annotations

import highspy
import numpy as np

from safestart.attitude.body_frame import rotation
from safestart.constraints.corridor import corridor_of
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.engines.base import Problem
from safestart.model.scenario import Floats, Rest


class BackwardLP:
    """Fixed-time backward set of a problem, one linear program per start."""

    def __init__(self, problem: Problem, *, hot: bool = False) -> None:
        self.hot = hot
        target = problem.scenario.target
        self.corridor = corridor_of(problem.scenario.corridor)
        count, a_max = problem.steps, problem.scenario.chaser.max_acceleration
        a = planar_transition(target.mean_motion, problem.dt)
        b = planar_input(target.mean_motion, problem.dt)
        turn = rotation(-target.tumble_rate * problem.horizon)
        omega = target.tumble_rate if problem.rest is Rest.BODY else 0.0
        start = np.vstack([np.eye(2), [[0.0, -omega], [omega, 0.0]]])
        self.drift = turn @ (np.linalg.matrix_power(a, count) @ start)[:2]
        gains = [turn @ (np.linalg.matrix_power(a, count - 1 - k) @ b)[:2] for k in range(count)]
        rows = np.hstack([self.corridor.normals @ np.hstack(gains), self.corridor.lengths[:, None]])
        faces, inputs = rows.shape[0], 2 * count
        model = highspy.HighsLp()
        model.num_col_, model.num_row_ = inputs + 1, faces
        model.col_cost_ = np.append(np.zeros(inputs), -1.0)
        model.col_lower_ = np.append(np.full(inputs, -a_max), -highspy.kHighsInf)
        model.col_upper_ = np.append(np.full(inputs, a_max), highspy.kHighsInf)
        model.row_lower_ = np.full(faces, -highspy.kHighsInf)
        model.row_upper_ = np.zeros(faces)
        model.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
        model.a_matrix_.start_ = np.arange(faces + 1) * (inputs + 1)
        model.a_matrix_.index_ = np.tile(np.arange(inputs + 1), faces)
        model.a_matrix_.value_ = rows.ravel()
        self.solver = highspy.Highs()
        self.solver.setOptionValue("output_flag", False)
        self.solver.setOptionValue("threads", 1)
        self.solver.passModel(model)

    def slack(self, point: Floats) -> float:
        """Largest common face slack (m) over the inputs, for one body-frame start (2,); >= 0 iff feasible."""
        bound = self.corridor.offsets - self.corridor.normals @ (self.drift @ point)
        for row, value in enumerate(bound):
            self.solver.changeRowBounds(row, -highspy.kHighsInf, float(value))
        if not self.hot:
            self.solver.clearSolver()
        self.solver.run()
        if self.solver.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            raise RuntimeError(f"HiGHS stopped with {self.solver.getModelStatus()}")
        return -float(self.solver.getInfo().objective_function_value)


def slack_map(problem: Problem, *, hot: bool = False) -> Floats:
    """Slack (ny, nx) of every cell: 961 linear programs on the paper's grid."""
    points = problem.points()
    program = BackwardLP(problem, hot=hot)
    return np.array([program.slack(p) for p in points.reshape(-1, 2)]).reshape(points.shape[:2])

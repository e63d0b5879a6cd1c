"""The closed loop of paper 000 with its filter (eq. 7) solved by OSQP from Python, one QP per control step.

At its best: the constraint matrix of a control step is the same for every start, so there is one OSQP object per
step, set up (and factorised) once; a flight updates vectors only and warm-starts each QP from the step before. Rows
are scaled to unit length and commands to a_max. The nominal command is the compiled one of safestart, so that what
differs is the solver and the language of the loop. Where OSQP reports infeasibility, the least-violating command
comes from HiGHS (scipy) and Clarabel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import clarabel
import numpy as np
import osqp
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import csc_matrix

from safestart.constraints.corridor import corridor_of
from safestart.control.gains import Gains
from safestart.control.regimes import control_law, nominal_command
from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.model.scenario import Scenario

Array = NDArray[np.float64]
SUBSTEPS = 3


@dataclass
class PeerFlight:
    """One flight: verdict, least face distance (m), states (S+1, 6) at the sub-steps, commands (K, d)."""

    safe: bool
    margin: float
    states: Array
    commands: Array
    infeasible: int


@dataclass
class OsqpLoop:
    """Flies starts one after the other; gains with keep-out or speed-limit rows are not supported."""

    scenario: Scenario
    gains: Gains
    dt: float
    steps: int
    nodes: int = 6
    planar: bool = True
    tolerance: float = 1e-6
    solvers: list[osqp.OSQP] = field(init=False)

    def __post_init__(self) -> None:
        assert self.gains.keep_out_radius == 0.0
        assert self.gains.speed_limit == 0.0
        n, self.a_max = self.scenario.target.mean_motion, self.scenario.chaser.max_acceleration
        self.d = 2 if self.planar else 3
        corridor = corridor_of(self.scenario.corridor, self.d)
        taus = [self.dt * j for j in range(1, self.nodes + 1)]
        phi = [transition_matrix(n, tau)[: self.d] for tau in taus]
        gamma = [input_matrix(n, tau)[: self.d, : self.d] * self.a_max for tau in taus]
        self.tau_sub = self.dt / SUBSTEPS
        self.phi, self.gamma = transition_matrix(n, self.tau_sub), input_matrix(n, self.tau_sub)[:, : self.d]
        self.offsets = corridor.offsets / corridor.lengths
        self.law = control_law(self.scenario, self.gains, self.dt)
        self.matrices, self.drifts, self.bounds, self.metres, self.faces = [], [], [], [], []
        self.solvers = []
        tightened = corridor.offsets - self.gains.corridor_margin
        weight = 1.0 + self.gains.effort_weight + self.gains.move_weight
        lower = np.full(len(tightened) * self.nodes + self.d, -np.inf)
        lower[-self.d :] = -1.0
        for k in range(self.steps):
            rows, drift, bound, metres = [], [], [], []
            for j in range(self.nodes):
                turned = corridor.normals @ self._rotation(k + j + 1)
                row = turned @ gamma[j]
                length = np.sqrt((row**2).sum(axis=1))
                rows.append(row / length[:, None])
                drift.append(turned @ phi[j] / length[:, None])
                bound.append(tightened / length)
                metres.append(length / corridor.lengths)
            matrix = np.vstack([*rows, np.eye(self.d)])
            self.matrices.append(matrix[: -self.d])
            self.drifts.append(np.vstack(drift))
            self.bounds.append(np.concatenate(bound))
            self.metres.append(np.concatenate(metres))
            unit = corridor.normals / corridor.lengths[:, None]
            self.faces.append([unit @ self._rotation(k + (s + 1) / SUBSTEPS) for s in range(SUBSTEPS)])
            solver = osqp.OSQP()
            solver.setup(
                csc_matrix(weight * np.eye(self.d)), np.zeros(self.d), csc_matrix(matrix), lower,
                np.ones(len(matrix)), verbose=False, eps_abs=self.tolerance, eps_rel=self.tolerance,
                eps_prim_inf=1e-7, max_iter=20_000, warm_starting=True, check_termination=5,
            )  # fmt: skip
            self.solvers.append(solver)
        self.start_faces = corridor.normals / corridor.lengths[:, None]

    def _rotation(self, intervals: float) -> Array:
        """R_z(-theta) after so many control intervals, (d, d)."""
        theta = self.scenario.target.tumble_rate * self.dt * intervals
        out = np.eye(self.d)
        out[:2, :2] = [[math.cos(theta), math.sin(theta)], [-math.sin(theta), math.cos(theta)]]
        return out

    def command(
        self, k: int, x: Array, nominal: Array, previous: Array, guess: tuple[Array, Array] | None
    ) -> tuple[Array, bool, tuple[Array, Array] | None]:
        """Solve (7) at step k: command (m/s^2), feasibility and the warm start for the next step."""
        solver = self.solvers[k]
        bound = self.bounds[k] - self.drifts[k] @ x
        linear = -(nominal + self.gains.move_weight * previous) / self.a_max
        solver.update(q=linear, u=np.concatenate([bound, np.ones(self.d)]))
        if guess is not None:
            solver.warm_start(x=guess[0], y=guess[1])
        result = solver.solve(raise_error=False)
        feasible = result.info.status_val in (1, 2)
        if feasible:
            scaled = np.asarray(result.x)
            guess = scaled, np.asarray(result.y)
        else:
            scaled = self.fallback(k, bound, linear)
            guess = None
        return self.a_max * scaled / max(float(np.linalg.norm(scaled)), 1.0), feasible, guess

    def fallback(self, k: int, bound: Array, linear: Array) -> Array:
        """The command (scaled) nearest to the unconstrained one among the least-violating ones in the box."""
        metres = self.metres[k]
        matrix = np.hstack([self.matrices[k] * metres[:, None], -np.ones((len(metres), 1))])
        cost = np.zeros(self.d + 1)
        cost[-1] = 1.0
        limits = [(-1.0, 1.0)] * self.d + [(None, None)]
        vertex: Array = linprog(cost, matrix, bound * metres, bounds=limits, method="highs").x
        relaxed = bound + max(0.0, vertex[-1]) / metres + 1e-8
        # The set of minimisers is thin: a first-order method crawls on it, an interior-point one does not.
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-12
        eye = np.eye(self.d)
        rows = csc_matrix(np.vstack([self.matrices[k], eye, -eye]))
        limit = np.concatenate([relaxed, np.ones(2 * self.d)])
        weight = 1.0 + self.gains.effort_weight + self.gains.move_weight
        cone = [clarabel.NonnegativeConeT(len(limit))]
        answer = clarabel.DefaultSolver(csc_matrix(weight * eye), linear, rows, limit, cone, settings).solve()
        return np.array(answer.x) if "Solved" in str(answer.status) else vertex[: self.d]

    def fly(self, start: Array) -> PeerFlight:
        """Fly one LVLH state (6,) to the end or to the first sub-step outside the corridor."""
        d = self.d
        x = np.array(start, dtype=np.float64)
        r0 = float(np.linalg.norm(x[:3]))
        v_max = self.gains.closing_factor * math.sqrt(self.a_max * r0)
        omega_dt = self.scenario.target.tumble_rate * self.dt
        previous, guess = np.zeros(d), None
        states, commands, infeasible = [x], [], 0
        margin = float((self.offsets - self.start_faces @ x[:d]).min())
        for k in range(self.steps):
            if margin < 0.0:
                break
            cos, sin = math.cos(omega_dt * k), math.sin(omega_dt * k)
            nominal = np.array(nominal_command(*x.tolist(), k * self.dt, cos, sin, r0, v_max, self.law)[:d])
            previous, feasible, guess = self.command(k, x, nominal, previous, guess)
            infeasible += not feasible
            commands.append(previous)
            push = self.gamma @ previous
            for face in self.faces[k]:
                x = self.phi @ x + push
                states.append(x)
                margin = min(margin, float((self.offsets - face @ x[:d]).min()))
                if margin < 0.0:
                    break
        return PeerFlight(
            margin >= 0.0, margin, np.array(states), np.array(commands).reshape(-1, d), infeasible
        )

    def fly_all(self, starts: Array) -> list[PeerFlight]:
        """Fly every row of ``starts`` (M, 6)."""
        return [self.fly(start) for start in starts]

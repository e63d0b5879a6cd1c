"""The tracking MPC: from a state and the attitudes ahead to a plan, and to the loop's commands."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

import numpy as np

from safestart.control.controller import Command
from safestart.control.tracking_mpc import equilibrium
from safestart.control.tracking_mpc.assemble import Fixed, assemble
from safestart.control.tracking_mpc.condensed import Condensed, condense
from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.step_kernel import SOLVED, feasible_starts, soften, solve_from
from safestart.control.tracking_mpc.theta_set import ThetaSet
from safestart.control.tracking_mpc.tuning import FIXED_TOLERANCE, DockingCorridor, Tuning
from safestart.errors import invalid
from safestart.model.scenario import Bools, Floats


@dataclass(frozen=True)
class Plan:
    """The result of one program.

    ``feasible``: all rows hold. ``violation`` t, m: violation of soft rows (0 if feasible); inf without any plan, and
    then the arrays are NaN. ``theta`` (3,) body axes; ``inputs`` (N_p, 3) body axes, m/s; ``states`` (N_p + 1, 6) LVLH;
    ``dual`` (R,) multipliers. ``status`` is the solver's.
    """

    feasible: bool
    violation: float
    theta: Floats
    inputs: Floats
    states: Floats
    cost: float
    dual: Floats
    status: int


class Program:
    """The rows, bounds and cost of one tuning, assembled for every step's attitudes."""

    def __init__(
        self,
        motion: Sampled,
        shape: DockingCorridor,
        tuning: Tuning,
        limit: ThetaSet,
        tightening: tuple[Floats, Floats] | None = None,
    ) -> None:
        """``tightening``: reduction of corridor rows (N_p + 1,), m, and inputs (N_p,), m/s, at every step."""
        self.motion, self.shape, self.tuning, self.limit = motion, shape, tuning, limit
        self.faces = shape.faces()
        self.condensed: Condensed = condense(motion, tuning.n_c, tuning.n_lqr, tuning.rho)
        total, count = tuning.inputs, len(self.faces.offsets)
        off_corridor, off_input = (np.zeros(total + 1), np.zeros(total)) if tightening is None else tightening
        sides, most = tuning.sides
        room = self.faces.offsets - off_corridor[motion.reached_from : total, None]
        pushing = np.repeat(most - off_input, len(sides))
        if (pushing <= 0.0).any():
            required = f"tightening below u_max, {tuning.u_max:g} m/s, at every step"
            raise invalid("u_max", required, float(off_input.max()))
        theta_high = limit.high.copy()
        if tuning.theta_limit != "zero":
            # The chaser stays at theta for ever, so theta keeps the distance of the last step.
            theta_high[:count] -= off_corridor[-1]
        self.high = np.concatenate([room.ravel(), pushing, theta_high])
        self.low = np.concatenate([np.full(room.size, -np.inf), -pushing, limit.low])
        self.give = np.concatenate(
            [
                np.ones(room.size),
                np.zeros(len(sides)),
                np.full(len(pushing) - len(sides), tuning.u_max),
                np.zeros(len(theta_high)),
            ]
        )
        self._allocate()
        self.fixed = Fixed(
            motion.weights,
            motion.flat,
            np.array([motion.p, motion.q, motion.r]),
            self.condensed.reach,
            self.condensed.push,
            self.condensed.cost,
            float(tuning.tau),
            np.ascontiguousarray(self.faces.normals),
            sides,
            np.ascontiguousarray(limit.normals),
        )

    def _allocate(self) -> None:
        """The arrays that a step fills."""
        n, size, total = 3 * self.tuning.n_c + 3, len(self.high), self.tuning.inputs
        self.rows, self.shift = np.empty((n, size)), np.empty((6, size))
        self.hessian, self.slope = np.empty((n, n)), np.empty((n, 6))
        # Maps of theta: to x_e(0), to positions in the body, to inputs in the body.
        self.start = np.empty((6, 3))
        self.spots, self.held = np.empty((total, 3, 3)), np.empty((total, 3, 3))

    def apart(self) -> Program:
        """Copy the program with arrays of its own: two threads must not fill the same ones."""
        other = copy(self)
        other._allocate()
        return other

    @property
    def ahead(self) -> int:
        """Number of attitudes that a program reads: this step's and N_p + m more, m weights of the motion."""
        return self.tuning.inputs - 1 + self.motion.ahead

    def assemble(self, attitudes: Floats) -> None:
        """Fill the rows for ``attitudes`` (>= ``ahead``, 3, 3) from this step on; raises ``InvalidInput`` for fewer."""
        if attitudes.shape[1:] != (3, 3) or len(attitudes) < self.ahead:
            raise invalid("attitudes", f"at least {self.ahead} rotations (3, 3)", attitudes.shape)
        attitudes = np.ascontiguousarray(attitudes[: self.ahead])
        maps = self.start, self.spots, self.held
        assemble(attitudes, self.fixed, *maps, self.rows, self.shift, self.hessian, self.slope)

    def fixed_violation(self, attitudes: Floats, states: Floats) -> Floats:
        """(...), m: largest violation by LVLH states (..., 6) at the nodes that no input reaches; <= 0 inside."""
        nodes = [states[..., :3] @ attitudes[0].T]
        if self.motion.reached_from > 1:
            nodes.append((states @ self.motion.a[:3].T) @ attitudes[1].T)
        out: Floats = -self.faces.slack(np.stack(nodes, axis=-2)).min(axis=(-2, -1))
        return out

    def plan(self, attitudes: Floats, state: Floats, *, soft: bool = False) -> Plan:
        """Assemble and solve from an LVLH ``state`` (6,); ``soft``: least violation if no plan keeps every row."""
        self.assemble(attitudes)
        state = np.ascontiguousarray(state, dtype=np.float64)
        z, dual = np.empty(len(self.rows)), np.empty(len(self.high))
        arrays = (self.rows, self.shift, self.hessian, self.slope, self.low, self.high)
        status, _ = solve_from(*arrays, state, z, dual)
        violation = max(0.0, float(self.fixed_violation(attitudes, state)) - FIXED_TOLERANCE)
        if status != SOLVED and soft:
            proof = dual.copy()
            status, least = soften(*arrays, self.give, state, z, dual)
            violation, dual = max(violation, least), proof
        if status != SOLVED:
            nothing = np.full((1, 3), np.nan)
            return Plan(False, np.inf, nothing[0], nothing, np.full((1, 6), np.nan), np.nan, dual, status)
        return self._plan(attitudes, state, z, dual, violation, status)

    def starts(self, attitudes: Floats, starts: Floats) -> Bools:
        """Whether the program has a plan for every LVLH start (S, 6): True, False."""
        self.assemble(attitudes)
        starts = np.ascontiguousarray(starts, dtype=np.float64)
        arrays = (self.rows, self.shift, self.hessian, self.slope, self.low, self.high)
        solved: Bools = feasible_starts(*arrays, starts) == SOLVED
        return solved & (self.fixed_violation(attitudes, starts) <= FIXED_TOLERANCE)

    def _plan(
        self, attitudes: Floats, state: Floats, z: Floats, dual: Floats, violation: float, status: int
    ) -> Plan:
        theta = z[-3:].copy()
        frames = attitudes[: self.ahead]
        targets = equilibrium.states(self.motion, frames[: self.motion.ahead]) @ theta
        deviation = np.concatenate([state - targets[0], z[:-3]])
        pushes = self.condensed.push @ deviation
        held = equilibrium.inputs(self.motion, frames) @ theta
        inputs = held + np.einsum("kij,kj->ki", frames[: len(pushes)], pushes)
        states = np.empty((len(pushes) + 1, 6))
        states[0] = state
        for j, given in enumerate(inputs):
            states[j + 1] = self.motion.after(states[j], frames[j].T @ given)
        cost = float(deviation @ self.condensed.cost @ deviation) + self.tuning.tau * float(theta @ theta)
        return Plan(violation == 0.0, violation, theta, inputs, states, cost, dual, status)


@dataclass(frozen=True, slots=True)
class PlannedInput(Command):
    """A command with the plan behind it."""

    plan: Plan | None = None


class TrackingMpc:
    """The controller for the loop: step k solves its program from navigation's current state.

    Held thrust belongs to its own interval. A planned impulse belongs to the end of its step, the loop's to the start
    of its interval: the impulse decided in step k - 1 acts at the start of interval k, and step k plans from the state
    after it.
    """

    def __init__(self, program: Program, attitudes: Floats, *, soft: bool = True) -> None:
        """``attitudes`` (K, 3, 3) at all nodes of the flight and ``program.ahead`` - 1 after it."""
        self.program, self.attitudes, self.soft = program, attitudes, soft
        self._due = np.zeros(3)

    def begin(self, state: Floats) -> None:  # noqa: ARG002
        """A new flight: no impulse is due."""
        self._due = np.zeros(3)

    def command(self, k: int, state: Floats) -> PlannedInput:
        """The held thrust of this interval; or the impulse decided a step ago, and the plan of the next one."""
        motion, impulse = self.program.motion, self._due
        after = np.array(state, dtype=np.float64)
        after[3:] += impulse
        plan = self.program.plan(self.attitudes[k:], after, soft=self.soft)
        given = self.attitudes[k].T @ plan.inputs[0] if plan.status == SOLVED else np.zeros(3)
        if motion.held:
            return PlannedInput(given / motion.period, plan.feasible, "tracking", np.zeros(3), plan)
        self._due = given
        return PlannedInput(np.zeros(3), plan.feasible, "tracking", impulse, plan)

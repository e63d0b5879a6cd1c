"""Starts from which the tracking MPC of paper 002 flies to the port, thrust held over the steps, in a ball.

The controller works in space; the benchmark's starts, its tumble and so its flights lie in the orbit plane. A start
counts if the loop, flown without errors, has a plan in every step, is inside at every node and ends at the port.
"""

from __future__ import annotations

import time

import numpy as np

from safestart.attitude.spin import Spin
from safestart.control.tracking_mpc.controller import Program
from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.theta_set import theta_set
from safestart.control.tracking_mpc.tuning import DockingCorridor, Tuning
from safestart.engines.base import EngineResult, Problem, ResultCode
from safestart.engines.tracking_options import TrackingSettings
from safestart.model.scenario import Floats, Scenario
from safestart.runtime.progress import Context
from safestart.simulation.starts import start_states, steps_of
from safestart.tracking.noisy_flight import Belief, NoisyFlights

T_SIM_S = 120.0
"""Flight time, whatever the problem's horizon."""
RADIUS_M = 0.5
WINDOW = 300
_ROUNDING = 1e-6
_SPHERE = np.eye(3)
_CHUNK = 32


class Tracking:
    """Flies every start inside the corridor from which the first program has a plan."""

    def __init__(self) -> None:
        self._settings = TrackingSettings.model_validate({})

    def solve(self, problem: Problem, context: Context) -> EngineResult:
        """The mask, without a margin: the controller knows its rows only at the nodes."""
        compile_s = self._warm_up(problem)
        begin = time.perf_counter()
        steps = steps_of(T_SIM_S, problem.dt)
        program, attitudes, port = self._program(problem.scenario, problem.dt, WINDOW + steps)
        inside = problem.inside()
        starts = start_states(problem.scenario, problem.points()[inside], problem.rest)
        context.step(0, len(starts) + 1, "plans")
        planned = program.starts(attitudes, starts)
        flights, rates = _flights(program, problem.scenario, steps)
        frames, still = np.ascontiguousarray(attitudes[: steps + 1]), np.zeros((steps + 1, 6))
        arrives = np.zeros(len(starts), dtype=bool)
        for index, start in enumerate(starts):
            if planned[index]:
                flown = flights.fly(start, frames, rates, still, np.ones(steps))
                near = abs(flown.last_range - port) <= RADIUS_M
                arrives[index] = flown.unplanned == 0 and flown.least_slack >= -_ROUNDING and near
            if index % _CHUNK == 0:
                context.step(index, len(starts), "flights")
        context.step(len(starts), max(1, len(starts)), "flights")
        mask = np.zeros_like(inside)
        mask[inside] = arrives
        run = time.perf_counter() - begin
        detail = {
            **self._settings.model_dump(),
            "rest": problem.rest.value,
            "t_sim_s": steps * problem.dt,
            "planned": int(planned.sum()),
            "arrived": int(arrives.sum()),
        }
        return EngineResult(ResultCode.OK, mask, None, run, compile_s, detail=detail)

    def _program(self, scenario: Scenario, dt: float, window: int) -> tuple[Program, Floats, float]:
        """The controller, the attitudes of a window of nodes, and the port's distance from the target."""
        shape, chosen = scenario.corridor, self._settings
        motion = Sampled(scenario.target.mean_motion, dt, held=True)
        tuning = Tuning(
            dt * scenario.chaser.max_acceleration,
            chosen.n_c,
            chosen.n_lqr,
            chosen.rho,
            chosen.tau,
            chosen.theta_limit,
            "ball",
        )
        corridor = DockingCorridor(1.0 / shape.c_x, 1.0 / shape.c_z, shape.x0, shape.z0, shape.hold_radius)
        count = window + tuning.inputs + motion.ahead
        attitudes = np.ascontiguousarray(
            Spin(scenario.target.tumble_rate).rotation(dt * np.arange(float(count)))
        )
        limit = theta_set(tuning, corridor, None, motion, attitudes)
        return Program(motion, corridor, tuning, limit), attitudes, shape.hold_radius

    def _warm_up(self, problem: Problem) -> float:
        """Compile the kernels, or load them from the cache, by one step of a flight; returns the seconds spent."""
        begin = time.perf_counter()
        program, attitudes, port = self._program(problem.scenario, problem.dt, 1)
        flights, rates = _flights(program, problem.scenario, 1)
        start = np.array([0.0, port + 0.1, 0.0, 0.0, 0.0, 0.0])
        program.starts(attitudes, start[None])
        flights.fly(start, np.ascontiguousarray(attitudes[:2]), rates, np.zeros((2, 6)), np.ones(1))
        return time.perf_counter() - begin


def _flights(program: Program, scenario: Scenario, steps: int) -> tuple[NoisyFlights, Floats]:
    """Flights about a sphere that spins steadily, and its inertial rates (steps + 1, 3) at the nodes."""
    target = scenario.target
    rates = np.tile([0.0, 0.0, target.tumble_rate + target.mean_motion], (steps + 1, 1))
    return NoisyFlights(program, Belief(_SPHERE, target.mean_motion), "soft", None), rates

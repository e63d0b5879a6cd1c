"""Closed-loop Monte Carlo: fly every grid start with the three-regime controller and its filter (paper 000, section 7).

A start is safe when no sub-step of its flight lies outside the rotating corridor. The controller is not optimal, so the
region is an inner estimate of the starts that some controller could fly; unlike the paper's other engines it covers the
whole flight.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.constraints.corridor import corridor_of
from safestart.control.forecast import flight_plan
from safestart.control.gains import preset
from safestart.engines.base import EngineResult, Problem, ResultCode
from safestart.model.scenario import Scenario
from safestart.runtime.progress import Context
from safestart.simulation.compiled_loop import fly
from safestart.simulation.record import Record
from safestart.simulation.starts import start_states, steps_of

T_SIM_S = 60.0
"""Flight time, whatever the problem's horizon."""
NODES = 6
"""Forecast nodes of the filter."""
PRESET = "tuned"
FLIGHTS_PER_CHUNK = 256
"""Flights between two progress reports: about 10 ms of work, so a dismissed job ends at once."""


class MonteCarlo:
    """Flies every start inside the corridor; cells of its set are safe only for this controller and flight time."""

    def solve(self, problem: Problem, context: Context) -> EngineResult:
        """Fly all cells inside the corridor, in the plane.

        ``margin`` is the least face distance of the flight in metres; negative where it left the corridor (the distance
        by which it was first seen outside), and the start's own distance outside the corridor.
        """
        steps = steps_of(T_SIM_S, problem.dt)
        compile_s = _warm_up(problem.scenario, problem.dt)
        begin = time.perf_counter()
        plan = flight_plan(problem.scenario, preset(PRESET), problem.dt, steps, nodes=NODES)
        inside = problem.inside()
        starts = start_states(problem.scenario, problem.points()[inside], problem.rest)
        count = len(starts)
        least = np.empty(count)
        tally = _Tally()
        context.step(0, max(1, count), "flights")
        for first in range(0, count, FLIGHTS_PER_CHUNK):
            part = slice(first, min(first + FLIGHTS_PER_CHUNK, count))
            flights = fly(plan, starts[part])
            if not flights.finite.all():
                message = (
                    f"the state of {int((~flights.finite).sum())} flights left the floating-point numbers"
                )
                run = time.perf_counter() - begin
                return EngineResult(ResultCode.NUMERICAL_FAILURE, None, None, run, compile_s, message)
            least[part] = flights.margin
            tally.add(flights)
            context.step(part.stop, count, "flights")

        corridor = corridor_of(problem.scenario.corridor)
        margin = (corridor.slack(problem.points()) / corridor.lengths).min(axis=-1)
        margin[inside] = least
        mask = inside & (margin >= 0.0)
        run = time.perf_counter() - begin
        detail = {
            "preset": PRESET,
            "rest": problem.rest.value,
            "t_sim_s": steps * problem.dt,
            "dt_s": problem.dt,
            "nodes": NODES,
            # One exact start per cell, under the same keys as in earlier documents.
            "samples": 1,
            "position_sigma_m": 0.0,
            "velocity_sigma_m_s": 0.0,
            "dimensions": 2,
            **tally.report(),
        }
        return EngineResult(ResultCode.OK, mask, margin, run, compile_s, detail=detail)


@dataclass(slots=True)
class _Tally:
    """Sums over all flights, for the result's detail."""

    flights: int = 0
    safe: int = 0
    steps: int = 0
    infeasible: int = 0
    delta_v: float = 0.0

    def add(self, flights: Record) -> None:
        self.flights += len(flights.margin)
        self.safe += int(flights.safe.sum())
        self.steps += int(flights.steps.sum())
        self.infeasible += int(flights.fallbacks.sum())
        self.delta_v += math.fsum(flights.delta_v)

    def report(self) -> dict[str, Any]:
        return {
            "flights": self.flights,
            "safe_flights": self.safe,
            "control_steps": self.steps,
            "infeasible_filter_calls": self.infeasible,
            "mean_delta_v_m_s": self.delta_v / self.flights if self.flights else 0.0,
        }


def _warm_up(scenario: Scenario, dt: float) -> float:
    """Compile the kernels, or load them from the cache, without a flight; returns the seconds spent."""
    begin = time.perf_counter()
    fly(flight_plan(scenario, preset(PRESET), dt, 1), np.empty((0, 6)))
    return time.perf_counter() - begin

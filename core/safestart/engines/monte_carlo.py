"""Closed-loop Monte Carlo: fly every grid start with the three-regime controller and its filter (paper 000, section 7).

A start is safe when no sub-step of its flight lies outside the rotating corridor. The controller is not optimal, so
the region is an inner estimate of what some controller could fly; unlike the paper's other engines it speaks
about the whole flight.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.constraints.corridor import corridor_of
from safestart.control.forecast import MAX_NODES, flight_plan
from safestart.control.gains import PRESETS, Gains, preset
from safestart.engines.base import EngineResult, Problem, ResultCode
from safestart.errors import invalid
from safestart.model.scenario import Floats, Scenario, number
from safestart.runtime.progress import Context
from safestart.simulation.compiled_loop import Flights, fly
from safestart.simulation.trajectory import start_states, steps_of

Indices = np.ndarray[tuple[Any, ...], np.dtype[np.signedinteger[Any]]]

MAX_SAMPLES = 100_000
MAX_T_SIM = 3600.0
FLIGHTS_PER_CHUNK = 256
"""Flights between two progress reports: about 10 ms of work, so a dismissed job ends at once."""


@dataclass(frozen=True, slots=True)
class Settings:
    """Options of the engine ``monte_carlo`` (``Problem.options``), with their defaults.

    ``t_sim_s`` is the flight time, independent of the problem's horizon and rounded up to whole control intervals;
    ``nodes`` is the filter's N; ``preset`` names the gains (``tuned`` or ``paper``). ``samples`` flights per cell
    start from positions and velocities dispersed with the standard deviations ``position_sigma_m`` and
    ``velocity_sigma_m_s`` on each of the three axes; without dispersion they would be alike, and one is flown.
    """

    t_sim_s: float = 60.0
    nodes: int = 6
    preset: str = "tuned"
    samples: int = 1
    position_sigma_m: float = 0.0
    velocity_sigma_m_s: float = 0.0

    def __post_init__(self) -> None:
        number("t_sim_s", self.t_sim_s, 0.0, MAX_T_SIM, open_low=True)
        for name, high in (("nodes", MAX_NODES), ("samples", MAX_SAMPLES)):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= high:
                raise invalid(name, f"an integer in [1, {high}]", value)
        if not isinstance(self.preset, str):
            raise invalid("preset", f"one of {', '.join(PRESETS)}", self.preset)
        preset(self.preset)
        number("position_sigma_m", self.position_sigma_m, 0.0, 1e6)
        number("velocity_sigma_m_s", self.velocity_sigma_m_s, 0.0, 1e3)

    @property
    def gains(self) -> Gains:
        """The preset's gains."""
        return preset(self.preset)

    @property
    def dispersed(self) -> bool:
        """Whether the starts are drawn rather than exact."""
        return self.position_sigma_m > 0.0 or self.velocity_sigma_m_s > 0.0


def settings_of(problem: Problem) -> Settings:
    """Read and check the engine's options; raises ``InvalidInput`` for an unknown name or a bad value."""
    names = tuple(Settings.__dataclass_fields__)
    problem.check_options(MonteCarlo.name, names)
    values: dict[str, Any] = {}
    for name in names:
        default = Settings.__dataclass_fields__[name].default
        values[name] = problem.option(MonteCarlo.name, name, default)
    return Settings(**values)


class MonteCarlo:
    """Flies every start inside the corridor; inside means safe for this controller, for the flight time only."""

    name = "monte_carlo"
    summary = (
        "closed-loop flights of the three-regime controller and its safety filter against exact CWH truth"
    )

    def solve(self, problem: Problem, context: Context) -> EngineResult:
        """Fly all cells inside the corridor, in the plane (in space when dispersed).

        ``margin`` is the least face distance of the flight in metres; negative where it left the corridor (the distance
        by which it was first seen outside), and the start's own distance outside the corridor. With samples it is
        the least over them, and ``mask`` asks for all of them; ``arrays["safe_fraction"]`` has their share.
        """
        settings = settings_of(problem)
        planar = not settings.dispersed
        steps = steps_of(settings.t_sim_s, problem.dt)
        compile_s = _warm_up(problem.scenario, settings, problem.dt)
        begin = time.perf_counter()
        plan = flight_plan(
            problem.scenario, settings.gains, problem.dt, steps, nodes=settings.nodes, planar=planar
        )
        inside = problem.inside()
        cells = np.flatnonzero(inside)
        starts = start_states(problem.scenario, problem.points().reshape(-1, 2)[cells], problem.rest)

        samples = settings.samples if settings.dispersed else 1
        least, fraction = np.empty(len(cells)), np.empty(len(cells))
        tally = _Tally()
        chunk = max(1, FLIGHTS_PER_CHUNK // samples)
        context.step(0, max(1, len(cells)), "flights")
        for first in range(0, len(cells), chunk):
            part = slice(first, min(first + chunk, len(cells)))
            batch = starts[part]
            if settings.dispersed:
                batch = _disperse(batch, cells[part], settings, problem.seed)
            flights = fly(plan, batch)
            if not flights.finite.all():
                message = (
                    f"the state of {int((~flights.finite).sum())} flights left the floating-point numbers"
                )
                run = time.perf_counter() - begin
                return EngineResult(
                    self.name, ResultCode.NUMERICAL_FAILURE, None, None, run, compile_s, message
                )
            least[part] = flights.margin.reshape(-1, samples).min(axis=1)
            fraction[part] = flights.safe.reshape(-1, samples).mean(axis=1)
            tally.add(flights)
            context.step(part.stop, len(cells), "flights")

        corridor = corridor_of(problem.scenario.corridor)
        margin = (corridor.slack(problem.points()) / corridor.lengths).min(axis=-1)
        margin[inside] = least
        mask = inside & (margin >= 0.0)
        arrays: dict[str, Floats] = {}
        if settings.samples > 1:
            shares = np.zeros(inside.shape)
            shares[inside] = fraction
            arrays["safe_fraction"] = shares
        run = time.perf_counter() - begin
        detail = {
            "preset": settings.preset,
            "rest": problem.rest.value,
            "t_sim_s": steps * problem.dt,
            "dt_s": problem.dt,
            "nodes": settings.nodes,
            "samples": settings.samples,
            "position_sigma_m": settings.position_sigma_m,
            "velocity_sigma_m_s": settings.velocity_sigma_m_s,
            "dimensions": 2 if planar else 3,
            **tally.report(),
        }
        return EngineResult(
            self.name, ResultCode.OK, mask, margin, run, compile_s, detail=detail, arrays=arrays
        )


@dataclass(slots=True)
class _Tally:
    """Sums over all flights, for the result's detail."""

    flights: int = 0
    safe: int = 0
    steps: int = 0
    infeasible: int = 0
    delta_v: float = 0.0

    def add(self, flights: Flights) -> None:
        self.flights += len(flights.margin)
        self.safe += int(flights.safe.sum())
        self.steps += int(flights.steps.sum())
        self.infeasible += int(flights.infeasible.sum())
        self.delta_v += math.fsum(flights.delta_v)

    def report(self) -> dict[str, Any]:
        return {
            "flights": self.flights,
            "safe_flights": self.safe,
            "control_steps": self.steps,
            "infeasible_filter_calls": self.infeasible,
            "mean_delta_v_m_s": self.delta_v / self.flights if self.flights else 0.0,
        }


def _disperse(starts: Floats, cells: Indices, settings: Settings, seed: int) -> Floats:
    """Samples of each start, (M * samples, 6); each cell has its own generator, so chunks do not matter."""
    sigma = np.repeat([settings.position_sigma_m, settings.velocity_sigma_m_s], 3)
    # SeedSequence takes non-negative integers only; any int maps to a distinct pair (sign, magnitude).
    key = [int(seed < 0), abs(seed)]
    noise = [
        np.random.default_rng([*key, int(cell)]).standard_normal((settings.samples, 6)) for cell in cells
    ]
    drawn: Floats = starts[:, None] + sigma * np.array(noise)
    return drawn.reshape(-1, 6)


def _warm_up(scenario: Scenario, settings: Settings, dt: float) -> float:
    """Compile the kernels, or load them from the cache, on no flight at all; seconds spent."""
    begin = time.perf_counter()
    fly(flight_plan(scenario, settings.gains, dt, 1), np.empty((0, 6)))
    return time.perf_counter() - begin

"""Fly the starts of one scenario with one controller: in a compiled loop if possible, else one after another."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from safestart.constraints.corridor import corridor_of
from safestart.control.controller import Controller
from safestart.control.forecast import Plan, flight_plan
from safestart.control.gains import Gains, preset
from safestart.control.limited import Limited
from safestart.control.sequence_mpc import SequenceMpc, start_verdict
from safestart.control.three_regimes import ThreeRegimes
from safestart.dynamics.registry import CWH
from safestart.exact.question import Question
from safestart.model.scenario import Rest, Scenario
from safestart.processes.sweep.cases import Cases
from safestart.processes.sweep.controllers import CONTROLLERS
from safestart.processes.sweep.inputs import SweepInputs
from safestart.processes.sweep.judge import UNASKED, Verdicts, of
from safestart.processes.wire import DT_S
from safestart.runtime.named import load
from safestart.simulation.compiled_loop import fly
from safestart.simulation.loop import fly as fly_slowly
from safestart.simulation.noise import DRAWS, Drawn, Truth, draws, truth_of
from safestart.simulation.plant import plant_of
from safestart.simulation.record import Record
from safestart.simulation.starts import start_states

# Flights between two checks for a dismissal, some 10 ms.
CHUNK = 500
NODES = 6


@dataclass(frozen=True, slots=True)
class JudgedFlights(Record):
    """M flights without paths; ``verdict`` (M,) is the exact answer if the controller knew it, else UNASKED."""

    verdict: Verdicts = field(default_factory=lambda: np.empty(0, np.int8))

    @classmethod
    def of(cls, flown: Record, verdict: Verdicts) -> JudgedFlights:
        """The flights, with the controller's verdicts on the starts."""
        return cls(
            flown.margin,
            flown.violated_at,
            flown.delta_v,
            flown.peak,
            flown.steps,
            flown.fallbacks,
            (),
            verdict,
        )


def gains_of(inputs: SweepInputs) -> Gains:
    """The preset, with the request's changes."""
    asked = inputs.filter
    changed = {
        "closing_factor": asked.closing_factor,
        "braking_share": asked.braking_share,
        "move_weight": asked.move_weight,
        "corridor_margin": asked.corridor_margin_m,
        "disk_limit": None if asked.disk_projection else 2.0,
    }
    return replace(preset(inputs.preset), **{name: v for name, v in changed.items() if v is not None})


def truth_from(inputs: SweepInputs) -> Truth:
    """The settings of the simulated world."""
    asked = inputs.truth
    return truth_of(
        asked.check,
        position_sigma=asked.navigation_position_sigma_m,
        velocity_sigma=asked.navigation_velocity_sigma_m_s,
        magnitude_sigma=asked.thrust_magnitude_sigma,
        direction_sigma=math.radians(asked.thrust_direction_sigma_deg),
        minimum_impulse=asked.minimum_impulse_m_s,
    )


def timing(inputs: SweepInputs, controller: str) -> tuple[float, int, int]:
    """Control interval (s), number of intervals and forecast nodes: the filter looks 12 s ahead at any interval."""
    dt = CONTROLLERS[controller].dt
    ratio = round(DT_S / dt)
    return dt, inputs.steps * ratio, NODES * ratio


def fly_all(inputs: SweepInputs, controller: str, cases: Cases, poll: Callable[[int], None]) -> JudgedFlights:
    """Fly every case; ``poll`` gets the number flown and may raise."""
    offered = CONTROLLERS[controller]
    if not offered.plan or inputs.truth.model != CWH:
        return _one_by_one(inputs, controller, cases, poll)
    _, steps, _ = timed = timing(inputs, controller)
    truth = truth_from(inputs)
    plan: Plan = load(offered.plan, f"plan of controller {controller}")(inputs, cases.scenario, *timed)
    starts = start_states(cases.scenario, cases.points, Rest.LVLH)
    parts = []
    for first in range(0, len(starts), CHUNK):
        rows = slice(first, first + CHUNK)
        drawn = draws(truth, inputs.seed, cases.numbers[rows], steps)
        parts.append(fly(plan, starts[rows], truth, drawn))
        poll(min(first + CHUNK, len(starts)))
    return JudgedFlights.of(Record.joined(parts), np.full(len(starts), UNASKED, dtype=np.int8))


def fly_one(
    inputs: SweepInputs, controller: str, cases: Cases, row: int, pilot: Controller | None = None
) -> Record:
    """One flight with its states and commands, the same as in the sweep."""
    dt, steps, _ = timing(inputs, controller)
    truth = truth_from(inputs)
    start = start_states(cases.scenario, cases.points[row : row + 1], Rest.LVLH)[0]
    drawn = draws(truth, inputs.seed, cases.numbers[row : row + 1], steps)
    return fly_slowly(
        plant_of(cases.scenario, inputs.truth.model),
        [corridor_of(cases.scenario.corridor)],
        pilot or controller_of(inputs, controller, cases),
        start,
        steps,
        dt,
        Drawn(truth, drawn[0] if len(drawn) else np.empty((0, DRAWS))),
    )


def controller_of(inputs: SweepInputs, controller: str, cases: Cases) -> Controller:
    """The controller of that name for a scenario."""
    offered = CONTROLLERS[controller]
    make = load(offered.make, f"make of controller {controller}")
    made: Controller = make(inputs, cases.scenario, *timing(inputs, controller))
    return made if offered.own_limit else Limited(made, cases.scenario.chaser.max_acceleration)


def plan_of(inputs: SweepInputs, scenario: Scenario, dt: float, steps: int, nodes: int) -> Plan:
    """Tables of the paper's safety filter, with the request's gains."""
    return flight_plan(scenario, gains_of(inputs), dt, steps, nodes=nodes)


def filter_of(inputs: SweepInputs, scenario: Scenario, dt: float, steps: int, nodes: int) -> Controller:
    """The safety filter of the paper, with the request's gains."""
    return ThreeRegimes(plan_of(inputs, scenario, dt, steps, nodes))


def sequence_of(_: SweepInputs, scenario: Scenario, dt: float, steps: int, __: int) -> Controller:
    """MPC over the whole thrust sequence."""
    return SequenceMpc(Question(scenario, dt, steps))


def _one_by_one(
    inputs: SweepInputs, controller: str, cases: Cases, poll: Callable[[int], None]
) -> JudgedFlights:
    pilot = controller_of(inputs, controller, cases)
    known = truth_from(inputs).position_sigma == truth_from(inputs).velocity_sigma == 0.0
    flights, verdicts = [], []
    for row in range(len(cases.points)):
        flown = fly_one(inputs, controller, cases, row, pilot)
        verdict = start_verdict(flown.paths[0].commands)
        # A plan from a noisy state proves nothing about the start itself.
        verdicts.append(of(verdict) if verdict is not None and known else UNASKED)
        flights.append(flown)
        poll(row + 1)
    return JudgedFlights.of(Record.joined(flights), np.array(verdicts, dtype=np.int8))

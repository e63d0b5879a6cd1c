"""Flying the starts of one scenario with one controller: compiled where that is possible, else one after another."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from safestart.control.forecast import flight_plan
from safestart.control.gains import Gains, preset
from safestart.model.scenario import Bools, Floats, Rest
from safestart.processes.sweep.cases import Cases
from safestart.processes.sweep.judge import UNASKED, Verdicts, of
from safestart.processes.sweep.spec import FINE_DT_S, SweepInputs
from safestart.processes.wire import DT_S
from safestart.simulation.compiled_loop import fly
from safestart.simulation.pilots import FilterPilot, Flown, Pilot, SequencePilot, fly_in
from safestart.simulation.trajectory import start_states
from safestart.simulation.truth import Truth, draws, truth_of
from safestart.simulation.worlds import CwhWorld, TwoBodyWorld, World

# Flights between two looks at a dismissal, some 10 ms.
CHUNK = 500
NODES = 6


@dataclass(frozen=True, slots=True)
class Outcome:
    """M flights: margin (m), time of the violation (s), impulse (m/s), control steps, steps without an admissible
    command; ``verdict`` is the exact answer where the controller knew it, else UNASKED.
    """

    margin: Floats
    violated_at: Floats
    delta_v: Floats
    steps: np.ndarray[tuple[int], np.dtype[np.int64]]
    fallbacks: np.ndarray[tuple[int], np.dtype[np.int64]]
    verdict: Verdicts

    @property
    def safe(self) -> Bools:
        """Flown without violation, and with numbers throughout."""
        return np.asarray((self.margin >= 0.0) & np.isinf(self.violated_at))


def gains_of(inputs: SweepInputs) -> Gains:
    """The preset with the settings that the request changes."""
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
    """The flown world's settings."""
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
    if controller != "filter_fine":
        return DT_S, inputs.steps, NODES
    ratio = round(DT_S / FINE_DT_S)
    return FINE_DT_S, inputs.steps * ratio, NODES * ratio


def fly_all(inputs: SweepInputs, controller: str, cases: Cases, poll: Callable[[int], None]) -> Outcome:
    """Fly every case; ``poll`` is told the number flown and may raise."""
    if controller == "sequence" or inputs.truth.model != "cwh":
        return _one_by_one(inputs, controller, cases, poll)
    dt, steps, nodes = timing(inputs, controller)
    truth = truth_from(inputs)
    plan = flight_plan(cases.scenario, gains_of(inputs), dt, steps, nodes=nodes)
    starts = start_states(cases.scenario, cases.points, Rest.LVLH)
    parts = []
    for first in range(0, len(starts), CHUNK):
        rows = slice(first, first + CHUNK)
        drawn = draws(truth, inputs.seed, cases.numbers[rows], steps)
        done = fly(plan, starts[rows], truth, drawn)
        margin = np.where(done.finite, done.margin, np.nan)
        parts.append((margin, done.violated_at, done.delta_v, done.steps, done.infeasible))
        poll(min(first + CHUNK, len(starts)))
    margin, late, impulse, flown, fallbacks = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Outcome(margin, late, impulse, flown, fallbacks, np.full(len(starts), UNASKED, dtype=np.int8))


def fly_one(
    inputs: SweepInputs, controller: str, cases: Cases, row: int, pilot: Pilot | None = None
) -> Flown:
    """One flight with its states and commands, the same as in the sweep."""
    dt, steps, _ = timing(inputs, controller)
    truth = truth_from(inputs)
    start = start_states(cases.scenario, cases.points[row : row + 1], Rest.LVLH)[0]
    drawn = draws(truth, inputs.seed, cases.numbers[row : row + 1], steps)
    pilot = pilot or pilot_of(inputs, controller, cases)
    world: World
    if inputs.truth.model == "cwh":
        world = CwhWorld(cases.scenario, start, dt)
    else:
        world = TwoBodyWorld(cases.scenario, start, dt)
    return fly_in(world, pilot, steps, dt, truth, drawn[0] if len(drawn) else np.empty((0, 6)))


def pilot_of(inputs: SweepInputs, controller: str, cases: Cases) -> Pilot:
    """The controller of a scenario."""
    dt, steps, nodes = timing(inputs, controller)
    if controller == "sequence":
        return SequencePilot(cases.scenario, dt, steps)
    return FilterPilot(cases.scenario, gains_of(inputs), dt, steps, nodes)


def _one_by_one(inputs: SweepInputs, controller: str, cases: Cases, poll: Callable[[int], None]) -> Outcome:
    pilot = pilot_of(inputs, controller, cases)
    known = truth_from(inputs).position_sigma == truth_from(inputs).velocity_sigma == 0.0
    rows: list[tuple[Any, ...]] = []
    for row in range(len(cases.points)):
        flown = fly_one(inputs, controller, cases, row, pilot)
        # A plan made from a noisy state says nothing about the start itself.
        verdict = of(flown.verdict) if flown.verdict is not None and known else UNASKED
        rows.append(
            (flown.margin, flown.violated_at, flown.delta_v, len(flown.commands), flown.fallbacks, verdict)
        )
        poll(row + 1)
    margin, late, impulse, steps, fallbacks, verdicts = (
        np.array(column) for column in zip(*rows, strict=True)
    )
    return Outcome(margin, late, impulse, steps, fallbacks, verdicts.astype(np.int8))

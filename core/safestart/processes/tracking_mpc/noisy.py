"""One shard of the study: runs with errors of navigation, input, spin and inertia, drawn per run."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from safestart.campaign.case import Case
from safestart.campaign.part import Part
from safestart.campaign.table import Table
from safestart.control.tracking_mpc.tube import Errors, tube_of
from safestart.processes.tracking_mpc.setup import Setup, setup_of
from safestart.processes.tracking_mpc.spec import StudyInput, TrackingMpcInputs
from safestart.processes.tracking_mpc.study import study_of
from safestart.runtime.progress import Context
from safestart.tracking.noisy_flight import Belief, NoisyFlights

ARRIVED_M = 0.5
SLACK = 1e-9


def runs(inputs: TrackingMpcInputs, part: dict[str, Any], context: Context) -> Part:
    """Fly the part's runs; the numbers of a run depend on seed and run alone."""
    begin = time.perf_counter()
    study, first, count = study_of(inputs), part["first"], part["count"]
    rows: list[dict[str, Any]] = []
    if inputs.study is not None:
        setup, flights = flights_of(inputs, inputs.study)
        for index in range(first, first + count):
            context.step(index - first, count, f"run {index - first + 1} of {count}")
            outcome = one(inputs, inputs.study, setup, flights, Case(index, inputs.seed))
            rows.append({"case": index, **outcome})
    table = Table.of_rows(study.columns, rows) if rows else Table.joined(study.columns, ())
    if not rows:
        return Part({"number": 0, "tally": study.tally.of(table), "run_s": 0.0})
    return study.part(first, table, time.perf_counter() - begin)


def flights_of(inputs: TrackingMpcInputs, study: StudyInput) -> tuple[Setup, NoisyFlights]:
    """The controller of a variant; for ``tube`` with its filter and tightened rows."""
    setup = setup_of(inputs)
    tube = None
    if study.variant == "tube":
        errors = Errors(
            study.position_sigma_m, study.velocity_sigma_m_s, study.input_sigma * inputs.u_max_m_s
        )
        tube = tube_of(setup.motion, setup.tuning, errors, bounded=study.tube == "bounded")
        setup = setup_of(inputs, (tube.corridor, tube.inputs))
    belief = Belief(
        np.array(setup.tumble.inertia),
        inputs.mean_motion if inputs.attitude_reference == "inertial" else 0.0,
    )
    return setup, NoisyFlights(setup.program, belief, study.variant, None if tube is None else tube.gain)


def one(
    inputs: TrackingMpcInputs, study: StudyInput, setup: Setup, flights: NoisyFlights, case: Case
) -> dict[str, Any]:
    """The outcome of a run."""
    rng, steps = case.generator(), inputs.steps
    body = setup.tumble.changed(study.inertia_sigma * rng.normal(size=3))
    spin = 1.0 + study.spin_sigma * float(rng.normal())
    navigation = rng.normal(size=(steps + 1, 6))
    navigation[:, :3] *= study.position_sigma_m
    navigation[:, 3:] *= study.velocity_sigma_m_s
    sizes = 1.0 + study.input_sigma * rng.normal(size=steps)
    times = inputs.period_s * np.arange(steps + 1.0)
    attitudes = np.ascontiguousarray(body.attitude.rotation(times))
    rates = np.ascontiguousarray(spin * body.body.angular_velocity(times))
    flown = flights.fly(setup.start, attitudes, rates, navigation, sizes)
    return {
        "inside": flown.least_slack >= -SLACK,
        "within_input": flown.largest_input <= inputs.u_max_m_s * (1.0 + SLACK),
        "always_planned": flown.unplanned == 0,
        "arrived": flown.last_range <= ARRIVED_M,
        "least_slack_m": flown.least_slack,
        "impulse_m_s": flown.impulse,
        "last_range_m": flown.last_range,
        "unplanned_steps": flown.unplanned,
    }

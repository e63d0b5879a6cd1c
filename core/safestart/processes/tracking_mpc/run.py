"""Run tracking-mpc: a shard flies its part of the study; the merge flies, certifies, asks for the region, draws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from safestart.campaign.part import Part
from safestart.campaign.records import MEDIA_TYPE
from safestart.control.tracking_mpc.theta_radius import ball_radius, bracket, printed_radius
from safestart.control.tracking_mpc.theta_set import theta_set
from safestart.control.tracking_mpc.tuning import ThetaLimit
from safestart.processes.base import Artifact, ProcessOutput
from safestart.processes.plotting import npz
from safestart.processes.tracking_mpc.files import flight_files, scene
from safestart.processes.tracking_mpc.plots import pictures
from safestart.processes.tracking_mpc.regions import maps, region
from safestart.processes.tracking_mpc.setup import LEAST_WINDOW, Setup, setup_of
from safestart.processes.tracking_mpc.spec import TrackingMpcInputs
from safestart.processes.tracking_mpc.statements import notes, statements
from safestart.processes.tracking_mpc.study import study_of, summary
from safestart.processes.wire import finite
from safestart.runtime.progress import Context
from safestart.tracking.any_history import AnyHistory
from safestart.tracking.certificate import cost_decrease, holds_until, recursion
from safestart.tracking.flight import TrackedFlight, fly
from safestart.tracking.printed_limit import counter_example


def shard(part: dict[str, Any], context: Context) -> Part:
    """The part's runs; without a study there is one empty part."""
    from safestart.processes.tracking_mpc.noisy import runs

    inputs = TrackingMpcInputs.model_validate(part["inputs"])
    return runs(inputs, part, context)


def merge(inputs: TrackingMpcInputs, parts: Sequence[Part], context: Context) -> ProcessOutput:
    """Everything but the study's runs."""
    setup = setup_of(inputs)
    histories = AnyHistory(
        setup.motion,
        setup.shape,
        inputs.u_max_m_s,
        setup.attitudes[: inputs.steps + 1],
        ball=inputs.input_limit == "ball",
    )
    exact = histories.answer(setup.start)
    flight = fly(
        setup.program, setup.tumble, setup.attitudes, setup.start, inputs.steps, inputs.truth, context
    )
    first = setup.program.plan(setup.attitudes, setup.start, soft=True)
    certificate = _certificate(inputs, setup, flight)
    unsafe = counter_example(
        setup.shape,
        setup.tumble,
        setup.motion,
        inputs.u_max_m_s,
        setup.attitudes[:LEAST_WINDOW],
        inputs.input_limit,
    )
    total = summary(inputs, [part.document for part in parts])
    document = {
        "feasible": first.feasible,
        "exact_feasible": exact.feasible,
        "least_violation_m": finite(first.violation),
        "exact_violation_m": finite(exact.violation),
        "exact_infeasibility_proved": exact.proved,
        **limits(inputs, setup),
        "printed_counter_example": None
        if unsafe is None
        else {
            "theta_m": unsafe.theta.tolist(),
            "time_s": unsafe.first * inputs.period_s,
            "largest_input_m_s": float(np.abs(unsafe.inputs).max()),
        },
        **_flown(inputs, setup, flight),
        "certificate": certificate,
        "predicted_body_m": _predicted(setup, flight),
        "region": None if inputs.region is None else region(inputs, setup, histories),
        "study": total["study"],
        "notes": notes(inputs, flight),
        "shards_done": total["shards_done"],
    }
    document["statements"] = statements(inputs, document)
    context.step(inputs.steps, inputs.steps + 1, "pictures")
    artifacts = list(pictures(setup, flight, document))
    if flight.plans:
        artifacts += [scene(setup, flight), *flight_files(setup, flight)]
    if document["region"] is not None:
        artifacts.append(maps(document["region"]))
    if unsafe is not None:
        arrays = {"state_lvlh": unsafe.states, "inputs_m_s": unsafe.inputs, "theta_m": unsafe.theta}
        artifacts.append(npz("counter_example.npz", arrays))
    records = b"" if inputs.study is None else study_of(inputs).recorded(parts)
    if records:
        artifacts.append(Artifact("runs.parquet", MEDIA_TYPE, records))
    return ProcessOutput(document, tuple(artifacts))


def limits(inputs: TrackingMpcInputs, setup: Setup) -> dict[str, Any]:
    """``theta_max_m`` and ``y_max_m``."""
    target, motion = setup.tumble, setup.motion
    _, most = setup.tuning.sides
    # Paper 002's formula is about impulses.
    printed = None if motion.held else printed_radius(target, motion, inputs.u_max_m_s)
    low, high = bracket(target, motion, most, inputs.input_limit)
    asked: tuple[ThetaLimit, ...] = ("printed", "corners")
    cuts = {
        name: None
        if name == "printed" and motion.held
        else theta_set(
            replace(setup.tuning, theta_limit=name), setup.shape, target, motion, setup.attitudes
        ).y_max
        for name in asked
    }
    return {
        "theta_max_m": {
            "printed": None if printed is None else finite(printed),
            "ball": finite(ball_radius(target, motion, most)),
            "exact_low": finite(low),
            "exact_high": finite(high),
            "printed_is_safe": None if printed is None else bool(printed <= low),
        },
        "y_max_m": {name: None if y is None or not 0.0 <= y < 1e4 else y for name, y in cuts.items()},
    }


def _flown(inputs: TrackingMpcInputs, setup: Setup, flight: TrackedFlight) -> dict[str, Any]:
    plans, flown = flight.plans, bool(flight.plans)
    settled = {name: flight.settled(radius) for name, radius in (("5", 0.05), ("1", 0.01))}
    slack = setup.program.faces.slack(flight.body).min(axis=1)
    return {
        "cost": plans[0].cost if flown else None,
        "theta_m": plans[0].theta.tolist() if flown else None,
        "inputs_m_s": flight.inputs.tolist(),
        **{
            f"time_to_{name}cm_s": None if node is None or not flown else node * inputs.period_s
            for name, node in settled.items()
        },
        "impulse_m_s": float(np.linalg.norm(flight.inputs, axis=1).sum()) if flown else None,
        "time_s": (inputs.period_s * np.arange(len(flight.states))).tolist(),
        "range_m": flight.ranges.tolist(),
        "cost_to_go": [plan.cost for plan in plans] + [None],
        "slack_m": slack.tolist(),
        "position_lvlh_m": flight.states[:, :3].tolist(),
        "position_body_m": flight.body.tolist(),
        "thetas_m": [plan.theta.tolist() for plan in plans],
    }


def _predicted(setup: Setup, flight: TrackedFlight) -> list[list[float]]:
    if not flight.plans:
        return []
    states = flight.plans[0].states
    body = np.einsum("kij,kj->ki", setup.attitudes[: len(states)], states[:, :3])
    return [[float(value) for value in row] for row in body]


def _certificate(inputs: TrackingMpcInputs, setup: Setup, flight: TrackedFlight) -> dict[str, Any] | None:
    if not flight.plans:
        return None
    program = setup.program
    shown = [
        recursion(program, setup.attitudes[k:], plan, setup.shifts) for k, plan in enumerate(flight.plans)
    ]
    low, _ = bracket(setup.tumble, setup.motion, setup.tuning.sides[1], inputs.input_limit)
    largest = max(float(np.linalg.norm(plan.theta)) for plan in flight.plans)
    return {
        "recursive_feasibility": {
            "holds": all(one.holds for one in shown) and flight.finished,
            "plans": sum(one.holds for one in shown),
            "least_corridor_m": finite(min(one.corridor for one in shown)),
            "least_input_m_s": finite(min(one.inputs for one in shown)),
            "beyond": finite(max(one.beyond for one in shown)),
            "shifts": setup.shifts,
        },
        "cost_decrease_margin": finite(cost_decrease(program, setup.attitudes, flight)),
        "theta_held_for_ever": bool(largest <= low),
        "theta_window_s": inputs.period_s * (len(setup.attitudes) - setup.motion.ahead),
        "verdict_holds_until_s": holds_until(
            program, setup.tumble, flight, inputs.inertia_error, inputs.spin_error
        ),
        "between_nodes_m": finite(flight.least_between),
    }

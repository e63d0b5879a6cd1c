"""Run flight-in-space: decide the start, fly it, watch the flight at all times."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from safestart.constraints.thrust_limit import ball
from safestart.engines.space.monte_carlo import FlownInSpace
from safestart.errors import UnfitResult, invalid
from safestart.exact.answer import TOLERANCE, Answer
from safestart.exact.search import Search
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.model_error import model_error
from safestart.exact.space.question import SpaceQuestion
from safestart.exact.space.watch import SpaceWatch, space_watch_of
from safestart.exact.watch import Minima
from safestart.model.scenario import MAX_ACCELERATION, Floats
from safestart.processes.base import ProcessOutput
from safestart.processes.flight_in_space.spec import FlightInSpaceInputs
from safestart.processes.start_in_space.flights import flown_curves
from safestart.processes.start_in_space.question import states_in, stay_in
from safestart.processes.wire import finite
from safestart.runtime.progress import Context


class _Flown(NamedTuple):
    """Thrusts (K, 3), LVLH, m/s^2, and the local minima of the distances; ``left_at`` s where the simulation saw it."""

    thrust: Floats
    minima: Minima
    left_at: float = math.inf


def run(inputs: FlightInSpaceInputs, context: Context) -> ProcessOutput:
    """Decide and fly."""
    question = stay_in(inputs, inputs.horizon_s)
    state = states_in(question, [inputs.start])[0]
    answer = decide_in_space(question, state)
    exact = inputs.flown_by == "exact"
    flown = _by_exact(question, state, answer) if exact else _by_sequence(question, state, inputs)
    context.step(1, 1, "flights")
    curves, minima = flown_curves(question, state, flown.thrust), flown.minima
    least = int(np.argmin(minima.values))
    left_at = min(flown.left_at, _outside(minima.times, minima.values), _outside_of(curves))
    return ProcessOutput(
        {
            "verdict": answer.verdict.value,
            "margin_m": finite(answer.proved_m),
            "model_error_m": model_error(question, state),
            "flown_by": inputs.flown_by,
            "faces": [face.name for face in question.faces],
            "stayed": "left" if math.isfinite(left_at) else "stayed",
            "closest_face": question.faces[int(minima.faces[least])].name,
            "closest_m": float(minima.values[least]),
            "closest_s": float(minima.times[least]),
            "left_at_s": finite(left_at),
            **curves,
        }
    )


def _outside(times: Floats, distances: Floats) -> float:
    found = times[distances < 0.0]
    return float(found.min()) if len(found) else math.inf


def _outside_of(curves: dict[str, Any]) -> float:
    return _outside(np.array(curves["time_s"]), np.array(curves["distance_m"]).min(axis=1))


def _by_exact(question: SpaceQuestion, state: Floats, answer: Answer) -> _Flown:
    """The witness of a GO; else the best flight that the search for it met."""
    watch, points = space_watch_of(question), answer.thrust
    if points is None:
        search = Search(watch, state)
        search.narrow(TOLERANCE)
        points = np.zeros((question.steps, question.channels)) if search.thrust is None else search.thrust
    return _Flown(watch.accelerations(points), watch.minima(state, points))


def _by_sequence(question: SpaceQuestion, state: Floats, inputs: FlightInSpaceInputs) -> _Flown:
    watch = space_watch_of(question)
    distances = watch.offsets - watch.normals @ state[:3]
    if float(distances.min()) < 0.0:
        outside = [name for name, d in zip(watch.names, distances, strict=True) if d < 0.0]
        raise invalid(
            "start", "a start inside all faces where a controller flies", f"outside {', '.join(outside)}"
        )
    sigma = (inputs.position_sigma_m, inputs.velocity_sigma_m_s)
    record = FlownInSpace(question, sigma, inputs.seed).fly(state, 0)
    if not record.finite[0]:
        raise UnfitResult("the flight left the floating-point numbers", required="numbers")
    thrust = record.paths[0].thrust
    # As thrusts of a ball they are the watch's own points.
    as_flown = replace(question, thrust=ball(MAX_ACCELERATION), steps=len(thrust))
    return _Flown(thrust, SpaceWatch(as_flown).minima(state, thrust), float(record.violated_at[0]))

"""Run flight: decide the start, fly its best thrust history, measure the distances."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from safestart.attitude.body_frame import body_to_lvlh, lvlh_to_body
from safestart.constraints.corridor import corridor_of
from safestart.dynamics.cwh import Cwh
from safestart.exact.best_flight import best_thrust
from safestart.exact.decide import decide
from safestart.exact.question import Goal, Question
from safestart.model.scenario import Floats, Rest, Scenario
from safestart.optim.prediction import prediction_of
from safestart.processes.base import ProcessOutput
from safestart.processes.course_files import course_files
from safestart.processes.flight.files import courses
from safestart.processes.flight.spec import FlightInputs
from safestart.processes.wire import DT_S, finite
from safestart.runtime.progress import Context

_PARTS = 4


def run(inputs: FlightInputs, context: Context) -> ProcessOutput:
    """Fly and measure."""
    start = inputs.start
    point = [start.x_m, start.y_m] if start.z_m is None else [start.x_m, start.y_m, start.z_m]
    flown = best_flight(
        inputs.scenario(), point, inputs.rest, inputs.question, inputs.horizon_s, inputs.within_s
    )
    context.step(1, 1)
    if inputs.mean_motion_rad_s == 0.0:
        return ProcessOutput(flown)
    return ProcessOutput(flown, course_files(courses(inputs.model_dump(mode="json"), flown)))


def best_flight(
    scenario: Scenario, point: Sequence[float], rest: Rest, asked: str, horizon_s: float, within_s: float
) -> dict[str, Any]:
    """The outputs for a start at rest at ``point``, body frame, m; see :class:`FlightOutputs`."""
    d, rate = len(point), scenario.target.tumble_rate
    stay = Question(scenario, DT_S, round(horizon_s / DT_S), d)
    question = stay
    if asked == "synchronize":
        question = Question(scenario, DT_S, round(within_s / DT_S), d, Goal())
    spin = rate if rest is Rest.BODY else 0.0
    at, speed = body_to_lvlh(np.array(point), np.zeros(d), spin, 0.0)
    state = np.concatenate([at, speed])
    answer = decide(question, state)
    thrust = best_thrust(stay, state) if answer.thrust is None else answer.thrust
    prediction = prediction_of(Cwh(scenario.target.mean_motion), DT_S, len(thrust), d, _PARTS)
    flown = prediction.flight(state, thrust)
    states = np.concatenate([flown[:, :-1].reshape(-1, 2 * d), flown[-1, -1:]])
    times: Floats = DT_S / _PARTS * np.arange(len(states), dtype=np.float64)
    body, _ = lvlh_to_body(states[:, :d], states[:, d:], rate, times)
    corridor = corridor_of(scenario.corridor, d)
    distance: Floats = corridor.slack(body) / corridor.lengths
    when, face = np.unravel_index(int(np.argmin(distance)), distance.shape)
    return {
        "verdict": answer.verdict.value,
        "margin_m": finite(answer.proved_m),
        "time_s": times.tolist(),
        "body_m": body.tolist(),
        "lvlh_m": states[:, :d].tolist(),
        "lvlh_m_s": states[:, d:].tolist(),
        "thrust_m_s2": [*np.repeat(thrust, _PARTS, axis=0).tolist(), thrust[-1].tolist()],
        "faces": list(corridor.names),
        "distance_m": distance.tolist(),
        "closest_face": corridor.names[int(face)],
        "closest_m": float(distance[when, face]),
        "closest_s": float(times[when]),
        "delta_v_m_s": DT_S * math.fsum(np.linalg.norm(thrust, axis=1)),
    }

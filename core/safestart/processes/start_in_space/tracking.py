"""Method tracking in space: the tracking MPC's flights, proved and certified, in place of the exact answer's GO."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from safestart.attitude.in_lvlh import InLvlh
from safestart.attitude.table import Table
from safestart.control.tracking_mpc.tuning import DockingCorridor
from safestart.errors import invalid
from safestart.exact.answer import Answer, Verdict
from safestart.exact.search import Search
from safestart.exact.space.question import SpaceQuestion, turned_from_y
from safestart.exact.space.watch import space_watch_of
from safestart.model.scenario import Floats
from safestart.processes.start_in_space.parts import FiveFaces
from safestart.processes.start_in_space.spec import UNKNOWNS, SpaceInputs
from safestart.processes.tracking_mpc import flown_answer as flown
from safestart.processes.wire import DT_S
from safestart.tracking.take import Approach, take

Flights = Callable[[Floats, Answer, str], tuple[Answer, str | None, dict[str, Any], str]]


def flights(inputs: SpaceInputs, question: SpaceQuestion) -> Flights:
    """A function from start (6,), exact answer and its words to answer, what decided it, ``TrackingAnswer`` and words.

    Raises ``InvalidInput`` for what the controller does not know.
    """
    if len(inputs.starts) > flown.MOST_STARTS:
        raise invalid("starts", f"at most {flown.MOST_STARTS} with method tracking", len(inputs.starts))
    if question.demands:
        raise invalid(
            question.demands.names[0], "no such demand with method tracking", question.demands.names
        )
    asks = {
        "question": question.plain and inputs.question == "stay",
        "hold_m": inputs.hold_m is None,
        "position_half_width_m": inputs.position_half_width_m == 0.0,
        "velocity_half_width_m_s": inputs.velocity_half_width_m_s == 0.0,
        **{name: getattr(inputs, name) == 0.0 for name in UNKNOWNS},
    }
    for name, known in asks.items():
        if not known:
            raise invalid(
                name,
                "stay for single starts, without a speed limit or hold point, with method tracking",
                name,
            )
    approach = _approach(inputs, question)

    def fly(state: Floats, exact: Answer, told: str) -> tuple[Answer, str | None, dict[str, Any], str]:
        def margin(thrust: Floats) -> float:
            watch = space_watch_of(replace(question, steps=len(thrust)))
            shares = _shares(question, thrust)
            return float(watch.minima(state, shares).lowest - Search(watch, state).rounding)

        flight = take(approach, state, margin)
        verdict, by = flown.verdict_of(flight, exact)
        words = flown.sentence(flight, exact, told, inputs.within_s)
        answer = exact
        if by == "tracking":
            thrust = _shares(question, flight.thrust)
            answer = Answer(Verdict.GO, flight.margin, flight.margin, np.inf, thrust, (), 0)
        elif verdict is Verdict.UNDECIDED:
            answer = replace(exact, verdict=verdict, margin_m=math.nan, thrust=None)
        return answer, by, flown.flown_answer(flight, exact), words

    return fly


def _approach(inputs: SpaceInputs, question: SpaceQuestion) -> Approach:
    corridor, orbit, thrust = inputs.corridor, question.orbit, question.thrust
    if not isinstance(corridor, FiveFaces):
        raise invalid("corridor", "the five faces with method tracking", "faces")
    if not orbit.circular:
        raise invalid("orbit", "a circular orbit with method tracking", orbit.eccentricity)
    inner = question.attitude.inertial if isinstance(question.attitude, InLvlh) else question.attitude
    if isinstance(inner, Table):
        raise invalid("attitude", "a spin or a torque-free body with method tracking", "table")
    if thrust.kind == "thrusters" or min(thrust.a_max) <= 0.0:
        raise invalid(
            "thrust", "a ball, or a box with every half-width above 0, with method tracking", thrust.kind
        )
    shape = corridor.shape()
    axis = (corridor.axis[0], corridor.axis[1], corridor.axis[2])
    return Approach(
        orbit.mean_motion,
        DT_S,
        DockingCorridor(1.0 / shape.c_x, 1.0 / shape.c_z, shape.x0, shape.z0, shape.hold_radius),
        question.attitude,
        # The largest ball in a box.
        flown.tuning_of(inputs.tracking, min(thrust.a_max)),
        most=round(inputs.within_s / DT_S),
        least=question.steps,
        radius=inputs.ball_radius_m,
        rest=inputs.rest_speed_m_s,
        turn=tuple(tuple(float(e) for e in row) for row in turned_from_y(axis).T),
    )


def _shares(question: SpaceQuestion, thrust: Floats) -> Floats:
    """LVLH thrusts (K, 3), m/s^2, as an answer holds them: a ball's as they are, a box's as shares in its own axes."""
    limit = question.thrust
    if limit.kind == "ball":
        return thrust
    if limit.frame == "body":
        frames = question.attitude.rotation(question.dt * np.arange(float(len(thrust))))
        thrust = np.einsum("kij,kj->ki", frames, thrust)
    out: Floats = thrust / np.array(limit.a_max)
    return out

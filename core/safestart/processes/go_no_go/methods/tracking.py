"""Method tracking: GO where the tracking MPC of paper 002, so tuned, is flown to rest at the port, with its proof.

The flight holds thrust over 2 s inside the disk or ball, its distances are bounded at all times, and all its plans are
certified. Where it does not arrive, the exact answer says whether any thrust history could.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from safestart.attitude.spin import Spin
from safestart.control.tracking_mpc.tuning import DockingCorridor
from safestart.errors import invalid
from safestart.exact.answer import Answer, Verdict
from safestart.exact.arrival import arrival_of
from safestart.exact.decide import decide as decide_start
from safestart.exact.prove import proof_of
from safestart.exact.question import Question
from safestart.exact.search import Search
from safestart.exact.watch import watch_of
from safestart.model.scenario import Floats
from safestart.processes.go_no_go import question as asked
from safestart.processes.go_no_go.answer import Verdicts
from safestart.processes.go_no_go.conditions import Conditions, points_of
from safestart.processes.go_no_go.methods.plain import KNOWN, more_asked
from safestart.processes.go_no_go.methods.proofs import in_lvlh
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.processes.tracking_mpc import flown_answer as flown
from safestart.processes.wire import DT_S, finite
from safestart.runtime.progress import Context
from safestart.tracking.take import Approach, Taken, take

_KNOWN = KNOWN | {"question", "after_arrival"}


def decide(inputs: GoNoGoInputs, _: Conditions, context: Context) -> Verdicts:
    """At most 50 starts; no speed limit, half-widths, disturbance or hold point elsewhere."""
    name = more_asked(inputs, _KNOWN)
    if name is not None:
        raise invalid(
            "method", f"exact or auto where {name} is given: the tracking MPC does not know it", "tracking"
        )
    hold, port = (inputs.hold_x_m, inputs.hold_y_m, inputs.hold_z_m), inputs.corridor.r_h_m
    if hold not in ((0.0, None, 0.0), (0.0, port, 0.0)):
        raise invalid("hold_y_m", "the middle of the hold plane: the tracking MPC goes nowhere else", hold)
    points = points_of(inputs)
    if len(points) > flown.MOST_STARTS:
        raise invalid("states", f"at most {flown.MOST_STARTS} with method tracking", len(points))
    question = asked.question_of(inputs, points.shape[-1])
    approach = _approach(inputs, question)
    verdicts: list[str] = []
    columns: dict[str, list[object]] = {
        "margin_m": [],
        "reason": [],
        "end_s": [],
        "proof": [],
        "decided_by": [],
        "tracking": [],
        "hold_after": [],
    }
    by_hold = question.goal is not None and inputs.after_arrival == "hold"
    for k, start in enumerate(in_lvlh(inputs, question, points)):
        flight, exact = _flight(question, approach, start), decide_start(question, start)
        answer = _answer(question, flight)
        if by_hold and flight.arrived is not None:
            answer = asked.with_hold_after(question, start, answer)
        stays = question.goal is None or asked.stays(inputs.after_arrival, answer)
        verdict, by = flown.verdict_of(flight, exact, stays=stays)
        answer = answer if by == "tracking" else exact
        verdicts.append(verdict.value)
        row = {
            "margin_m": finite(answer.proved_m) if by else None,
            "reason": flown.sentence(
                flight, exact, asked.sentence(question, exact), inputs.within_s, stays=stays
            ),
            "end_s": flight.arrived * DT_S if by == "tracking" and flight.arrived else None,
            "proof": proof_of(_covering(question, answer), start, answer) if by and inputs.proofs else None,
            "decided_by": by,
            "tracking": flown.flown_answer(flight, exact),
            "hold_after": None if verdict is Verdict.NO_GO else asked.told_of_hold(answer.held),
        }
        for column, value in row.items():
            columns[column].append(value)
        context.step(k + 1, len(points), "starts")
    if question.goal is None:
        del columns["end_s"]
    if not inputs.proofs:
        del columns["proof"]
    if not by_hold:
        del columns["hold_after"]
    return Verdicts(verdicts, **columns)  # type: ignore[arg-type]


def _approach(inputs: GoNoGoInputs, question: Question) -> Approach:
    """The controller's task: to rest at the middle of the hold plane."""
    target, shape = question.scenario.target, question.scenario.corridor
    corridor = DockingCorridor(1.0 / shape.c_x, 1.0 / shape.c_z, shape.x0, shape.z0, shape.hold_radius)
    return Approach(
        target.mean_motion,
        DT_S,
        corridor,
        Spin(target.tumble_rate),
        flown.tuning_of(inputs.tracking, inputs.a_max_m_s2),
        most=round(inputs.within_s / DT_S),
        least=question.steps if question.goal is None else 1,
        radius=inputs.ball_radius_m,
        rest=inputs.rest_speed_m_s,
    )


def _flight(question: Question, approach: Approach, start: Floats) -> Taken:
    """The flight from an LVLH ``start`` (2 d,), its margin bounded at all times."""
    d = question.dimensions
    whole = np.zeros(6)
    whole[:d], whole[3 : 3 + d] = start[:d], start[d:]

    def margin(thrust: Floats) -> float:
        goal = question.goal and replace(question.goal, earliest=1)
        watch = watch_of(replace(question, steps=len(thrust), goal=goal))
        return float(watch.minima(start, thrust[:, :d]).lowest - Search(watch, start).rounding)

    return take(approach, whole, margin)


def _answer(question: Question, flight: Taken) -> Answer:
    """The flight as a GO of the exact question; of `synchronize` with how it goes on after its end."""
    rows, d = len(flight.thrust), question.dimensions
    arrival = None
    if question.goal is not None and flight.arrived is not None:
        end = flight.states[-1]
        arrival = arrival_of(question, np.concatenate([end[:d], end[3 : 3 + d]]), rows * question.dt)
    thrust = flight.thrust[:, :d]
    return Answer(Verdict.GO, flight.margin, flight.margin, np.inf, thrust, (), 0, arrival=arrival)


def _covering(question: Question, answer: Answer) -> Question:
    """The question `stay` over the whole flight where it arrives after ``horizon_s``: all that is said is proved."""
    if question.goal is not None or answer.thrust is None or len(answer.thrust) <= question.steps:
        return question
    return replace(question, steps=len(answer.thrust))

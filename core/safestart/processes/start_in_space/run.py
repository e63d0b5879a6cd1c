"""Run start-in-space: one cone program per start."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from safestart.errors import invalid
from safestart.exact.answer import Answer, Verdict
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.demands.demanded import lost_at_start
from safestart.exact.space.demands.rules import VIEW
from safestart.exact.space.model_error import model_error
from safestart.exact.space.prove import proof_in_space
from safestart.exact.space.question import SpaceQuestion
from safestart.exact.space.start_box import decide_from_box
from safestart.exact.space.watch import space_watch_of
from safestart.model.scenario import Floats
from safestart.processes.base import ProcessOutput
from safestart.processes.go_no_go import question as asked
from safestart.processes.start_in_space.flights import curves, turning
from safestart.processes.start_in_space.question import half_of, question_of, states_of
from safestart.processes.start_in_space.spec import MOST_PROOFS, SpaceInputs
from safestart.processes.wire import finite
from safestart.runtime.progress import Context


def run(inputs: SpaceInputs, context: Context) -> ProcessOutput:
    """Answer for every start."""
    for name in ("proofs", "flights"):
        if getattr(inputs, name) and len(inputs.starts) > MOST_PROOFS:
            raise invalid(name, f"at most {MOST_PROOFS} starts", len(inputs.starts))
    question = question_of(inputs)
    states = states_of(inputs, question)
    half = half_of(inputs)
    if half is not None and not question.plain:
        asked_more = ", ".join(question.demands.names) or question.kind
        raise invalid(
            "question", "stay without speed limit and demands where half-widths are given", asked_more
        )
    watch = space_watch_of(question)
    flown = _by_tracking(inputs, question) if inputs.method == "tracking" else None
    answers, deciders, tracking = [], list[str | None](), []
    prover = "exact" if half is None and not question.unknowns else "families"
    for k, state in enumerate(states):
        answer = decide_in_space(question, state) if half is None else decide_from_box(question, state, half)
        by = prover
        if flown is not None:
            answer, by, said, told = flown(state, answer, _told(question, half, answer))
            tracking.append((said, told))
        answers.append(answer)
        deciders.append(None if answer.verdict is Verdict.UNDECIDED else by)
        context.step(k + 1, len(states), "starts")
    spans = [_covering(question, answer) for answer in answers]
    errors = [model_error(span, state) for span, state in zip(spans, states, strict=True)]
    distances = (watch.offsets - states[:, :3] @ watch.normals.T).tolist()
    proof: list[dict[str, Any] | None] | None = None
    if inputs.proofs:
        proof = [
            None if answer.verdict is Verdict.UNDECIDED else proof_in_space(span, state, answer, half)
            for span, state, answer in zip(spans, states, answers, strict=True)
        ]
    return ProcessOutput(
        {
            "method": inputs.method,
            "question": question.kind,
            "faces": list(watch.names),
            "verdict": [answer.verdict.value for answer in answers],
            "decided_by": deciders,
            "margin_m": [finite(answer.proved_m) for answer in answers],
            "model_error_m": errors,
            "violated_faces": [
                [name for name, distance in zip(watch.names, row, strict=True) if distance < 0.0]
                + _demands_violated(question, state)
                for row, state in zip(distances, states, strict=True)
            ],
            "position_m": states[:, :3].tolist(),
            "velocity_m_s": states[:, 3:].tolist(),
            "reason": [
                _sentence(answer, error, tracking[k][1] if tracking else _told(question, half, answer))
                for k, (answer, error) in enumerate(zip(answers, errors, strict=True))
            ],
            "end_s": [_end(question, answer) for answer in answers] if question.goal else None,
            "restriction": [list(answer.restriction) for answer in answers] if question.demands else None,
            "flight": [
                None
                if answer.verdict is not Verdict.GO or answer.thrust is None
                else curves(span, state, answer.thrust)
                for span, state, answer in zip(spans, states, answers, strict=True)
            ]
            if inputs.flights
            else None,
            "turning": turning(max(spans, key=lambda one: one.steps)) if inputs.flights else None,
            "tracking": [said for said, _ in tracking] or None,
            "proof": proof,
        }
    )


def _by_tracking(inputs: SpaceInputs, question: SpaceQuestion) -> Any:
    """The flights of method tracking; imported here, as no other method needs a compiler."""
    from safestart.processes.start_in_space.tracking import flights

    return flights(inputs, question)


def _covering(question: SpaceQuestion, answer: Answer) -> SpaceQuestion:
    """The question `stay` over a whole flight that arrives after ``horizon_s``: all said is proved, and shown."""
    if question.goal is not None or answer.thrust is None or len(answer.thrust) <= question.steps:
        return question
    return replace(question, steps=len(answer.thrust))


def _end(question: SpaceQuestion, answer: Answer) -> float | None:
    if answer.verdict is not Verdict.GO or answer.thrust is None:
        return None
    return len(answer.thrust) * question.dt


def _sentence(answer: Answer, error: float, told: str) -> str:
    """The verdict in words, with a warning where the linear model's own error may be larger than the margin."""
    if abs(answer.margin_m) < error:
        return f"{told}; the linear model itself may be off by about {error:.2g} m"
    return told


def _told(question: SpaceQuestion, half: Floats | None, answer: Answer) -> str:
    if half is not None or question.unknowns:
        return _for_all(question, answer, box=half is not None)
    at_start = lost_at_start(question.demands, answer)
    if at_start:
        return f"the start itself is {-answer.upper:.2f} m on the wrong side of {at_start}"
    if answer.verdict is Verdict.GO and answer.restriction:
        told = asked.told(question, answer)
        return f"{told}; found in a convex part of what is asked ({'; '.join(answer.restriction)})"
    if answer.verdict is Verdict.NO_GO and question.demands:
        rows = (*answer.multipliers, *(row for part in answer.parts for row in part.multipliers))
        by = VIEW if any(row.face == VIEW for row in rows) else ""
        without = [name for name in question.demands.names if name != by]
        return f"{asked.told(question, answer, by)}{', even without ' if without else ''}{', '.join(without)}"
    return asked.told(question, answer)


def _demands_violated(question: SpaceQuestion, state: Floats) -> list[str]:
    if not question.demands:
        return []
    body = question.attitude.rotation(np.zeros(1))[0] @ state[:3]
    return [name for name, room in question.demands.rooms(state[:3], body) if room < 0.0]


def _for_all(question: SpaceQuestion, answer: Answer, *, box: bool) -> str:
    """The verdict on a box of starts, or on all members of what is not known."""
    span, from_box = question.horizon, ", from all starts of the box" if box else ""
    members = ", for every member of what is not known" if question.unknowns else ""
    if answer.verdict is Verdict.UNDECIDED:
        return f"undecided: {answer.reason}"
    if answer.verdict is Verdict.GO:
        return (
            f"one thrust history keeps {answer.lower:.2f} m to every face for {span:g} s{from_box}{members}"
        )
    of_all = "from no start of the box" if box else "no"
    stated = ", even where all is as given" if question.unknowns else ""
    return (
        f"{of_all} thrust {asked.held(question)} stays for {span:g} s{stated}: each history is at some time at least "
        f"{-answer.upper:.2f} m outside a face"
    )

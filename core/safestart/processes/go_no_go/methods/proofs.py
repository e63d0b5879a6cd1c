"""Shared by the proving methods: the question and the starts in LVLH, sets around them, proof documents."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from safestart.attitude.body_frame import body_to_lvlh
from safestart.disturbance.prove import proof_against
from safestart.disturbance.tube import Disturbance, tube_of
from safestart.errors import invalid
from safestart.exact.answer import Answer, Verdict
from safestart.exact.prove import proof_of
from safestart.exact.question import Question
from safestart.model.scenario import Floats, Rest
from safestart.processes.go_no_go import question as asked
from safestart.processes.go_no_go.answer import Verdicts
from safestart.processes.go_no_go.conditions import points_of
from safestart.processes.go_no_go.cost import MOST_PROGRAMS as MOST_PROGRAMS
from safestart.processes.go_no_go.methods import disturbed
from safestart.processes.go_no_go.methods.families import decide_families
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.processes.wire import finite
from safestart.runtime.progress import Context

MOST_PROOFS = MOST_SEARCHES = 100

Solved = tuple[list[Answer], list[str]]
"""An answer for each start, and what gave it."""
Solve = Callable[[Question, Floats, Context], Solved]


def prove(inputs: GoNoGoInputs, solve: Solve, context: Context) -> Verdicts:
    """Verdicts with half-widths, against a disturbance, or else by ``solve`` over the starts (S, 2 d), LVLH."""
    points = points_of(inputs)
    question = asked.question_of(inputs, points.shape[-1])
    if inputs.proofs and len(points) > MOST_PROOFS:
        raise invalid("proofs", f"at most {MOST_PROOFS} starts", len(points))
    if not question.plain and len(points) > MOST_SEARCHES:
        raise invalid("states", f"at most {MOST_SEARCHES} with synchronize or a speed limit", len(points))
    starts = in_lvlh(inputs, question, points)
    disturbance = disturbed.disturbance_of(inputs)
    if inputs.uncertain:
        if disturbance is not None:
            raise invalid("disturbance_m_s2", "no half-widths beside it", "both")
        return decide_families(inputs, question, starts, context)
    if disturbance is not None:
        if len(points) > MOST_PROGRAMS:
            raise invalid("states", f"at most {MOST_PROGRAMS} against a disturbance", len(points))
        answers, by = disturbed.decide(disturbance, question, starts, context), ["tube"] * len(starts)
        reasons = [disturbed.sentence(disturbance, question, answer) for answer in answers]
    else:
        answers, by = solve(question, starts, context)
        answers = asked.with_arrival(inputs.after_arrival, question, starts, answers)
        reasons = [asked.sentence(question, answer) for answer in answers]
    return Verdicts(
        [answer.verdict.value for answer in answers],
        [finite(answer.proved_m) for answer in answers],
        reasons,
        end_s=[_end(question, answer) for answer in answers] if question.goal else None,
        hold_after=asked.hold_after(inputs, question, answers),
        proof=[_proof(disturbance, question, *each) for each in zip(starts, answers, strict=True)]
        if inputs.proofs
        else None,
        decided_by=[
            None if answer.verdict is Verdict.UNDECIDED else name
            for answer, name in zip(answers, by, strict=True)
        ],
    )


def in_lvlh(inputs: GoNoGoInputs, question: Question, points: Floats) -> Floats:
    """Position and velocity (S, 2 d) of the starts, LVLH."""
    rate = question.scenario.target.tumble_rate if inputs.rest is Rest.BODY else 0.0
    return np.concatenate(body_to_lvlh(points, np.zeros_like(points), rate, 0.0), axis=-1)


def _end(question: Question, answer: Answer) -> float | None:
    if answer.verdict is not Verdict.GO or answer.thrust is None:
        return None
    return len(answer.thrust) * question.dt


def _proof(
    disturbance: Disturbance | None, question: Question, start: Floats, answer: Answer
) -> dict[str, Any] | None:
    """The document of a decided answer; None for an undecided one."""
    if answer.verdict is Verdict.UNDECIDED:
        return None
    if disturbance is None:
        return proof_of(question, start, answer)
    return proof_against(question, disturbance, tube_of(question, disturbance), start, answer)

"""Proved verdicts for go-no-go: one cone program per start, or an atlas where there are many."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safestart.attitude.body_frame import body_to_lvlh
from safestart.errors import invalid
from safestart.exact.decide import Answer, Verdict, decide
from safestart.exact.question import Question
from safestart.model.scenario import Floats, Rest
from safestart.processes.go_no_go.atlases import atlas_for
from safestart.processes.go_no_go.disturbed import disturbance_of, told, under
from safestart.processes.go_no_go.families import decide_families
from safestart.processes.go_no_go.question import question_of, sentence
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.runtime.progress import Context

MOST_PROGRAMS = 1000
MOST_PROOFS = MOST_SEARCHES = 100
_MANY = 100
"""Starts from which on building an atlas (some tens of cone programs) pays."""


def prove_all(inputs: GoNoGoInputs, points: Floats, context: Context) -> dict[str, list[Any] | None]:
    """Verdict, margin, sentence and, when asked for, proof of every start; replaces the closed form's own."""
    question = question_of(inputs, points.shape[-1])
    if inputs.proofs and len(points) > MOST_PROOFS:
        raise invalid("proofs", f"at most {MOST_PROOFS} starts", len(points))
    if inputs.method == "exact" and len(points) > MOST_PROGRAMS:
        raise invalid("states", f"at most {MOST_PROGRAMS} with method exact; auto takes more", len(points))
    if not question.plain and len(points) > MOST_SEARCHES:
        raise invalid("states", f"at most {MOST_SEARCHES} with synchronize or a speed limit", len(points))
    rate = question.scenario.target.tumble_rate if inputs.rest is Rest.BODY else 0.0
    at, velocity = body_to_lvlh(points, np.zeros_like(points), rate, 0.0)
    starts = np.concatenate([at, velocity], axis=-1)
    asked, disturbance = [question] * len(starts), disturbance_of(inputs)
    if inputs.uncertain:
        if disturbance is not None:
            raise invalid("disturbance_m_s2", "no half-widths beside it", "both")
        return decide_families(inputs, question, starts, context)
    if disturbance is not None:
        if len(points) > MOST_PROGRAMS:
            raise invalid("states", f"at most {MOST_PROGRAMS} against a disturbance", len(points))
        asked, answers = under(disturbance, question, starts, context)
    elif inputs.method == "auto" and question.plain and points.shape[-1] == 2 and inputs.rest is Rest.LVLH:
        answers = _by_atlas(question, starts, context)
    else:
        if len(points) > MOST_PROGRAMS:
            raise invalid(
                "states", f"at most {MOST_PROGRAMS} in space or at rest in the body frame", len(points)
            )
        answers = _one_by_one(question, starts, context)
    return {
        "verdict": [answer.verdict.value for answer in answers],
        "margin_m": [answer.margin_m if math.isfinite(answer.margin_m) else None for answer in answers],
        "reason": [
            sentence(question, answer) if disturbance is None else told(disturbance, question, answer)
            for answer in answers
        ],
        "end_s": [_end(question, answer) for answer in answers] if question.goal else None,
        "proof": [_proof(q, s, a) for q, s, a in zip(asked, starts, answers, strict=True)]
        if inputs.proofs
        else None,
    }


def _one_by_one(question: Question, starts: Floats, context: Context) -> list[Answer]:
    answers = []
    for k, start in enumerate(starts):
        answers.append(decide(question, start))
        context.step(k + 1, len(starts), "starts")
    return answers


def _by_atlas(question: Question, starts: Floats, context: Context) -> list[Answer]:
    """Atlas first; what lies in its undecided strip is solved, as far as the number of programs allows.

    Few starts ask an atlas that is there and are solved otherwise; many have one built.
    """
    many = len(starts) >= _MANY
    atlas = atlas_for(question, float(starts[:, 1].max()), context, make=many)
    if atlas is None:
        return _one_by_one(question, starts, context)
    lower, upper = atlas.bounds(starts[:, :2])
    answers, solved = [], 0
    for start, low, high in zip(starts, lower.tolist(), upper.tolist(), strict=True):
        if low > 0.0 or high < 0.0 or solved >= MOST_PROGRAMS:
            answers.append(atlas.answer(start[:2]))
        else:
            answers.append(decide(question, start, verdict_only=many))
            solved += 1
        context.step(len(answers), len(starts), "starts")
    return answers


def _end(question: Question, answer: Answer) -> float | None:
    if answer.verdict is not Verdict.GO or answer.thrust is None:
        return None
    return len(answer.thrust) * question.dt


def _proof(question: Question, start: Floats, answer: Answer) -> dict[str, Any] | None:
    from safestart.exact.prove import proof_of

    return None if answer.verdict is Verdict.UNDECIDED else proof_of(question, start, answer)

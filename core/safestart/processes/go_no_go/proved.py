"""Proved verdicts for go-no-go: one cone program per start, or an atlas where there are many."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safestart.certificates.exact import Answer, Verdict, decide
from safestart.certificates.question import Question
from safestart.dynamics.body_frame import body_to_lvlh
from safestart.errors import invalid
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.progress import Context
from safestart.scenario import MAX_RANGE, Floats, Rest

DT_S = 2.0
MOST_PROGRAMS = 1000
MOST_PROOFS = 100
_MANY = 100
"""Starts from which on an atlas (some tens of cone programs) pays."""


def prove_all(inputs: GoNoGoInputs, points: Floats, context: Context) -> dict[str, list[Any] | None]:
    """Verdict, margin, sentence and, when asked for, proof of every start; replaces the closed form's own."""
    question = Question(inputs.scenario(), DT_S, round(inputs.horizon_s / DT_S), points.shape[-1])
    if inputs.proofs and len(points) > MOST_PROOFS:
        raise invalid("proofs", f"at most {MOST_PROOFS} starts", len(points))
    if inputs.method == "exact" and len(points) > MOST_PROGRAMS:
        raise invalid("states", f"at most {MOST_PROGRAMS} with method exact; auto takes more", len(points))
    rate = question.scenario.target.tumble_rate if inputs.rest is Rest.BODY else 0.0
    at, velocity = body_to_lvlh(points, np.zeros_like(points), rate, 0.0)
    starts = np.concatenate([at, velocity], axis=-1)
    if (
        inputs.method == "auto"
        and points.shape[-1] == 2
        and inputs.rest is Rest.LVLH
        and len(points) >= _MANY
    ):
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
        "reason": [_sentence(answer, inputs.horizon_s) for answer in answers],
        "proof": [_proof(question, s, a) for s, a in zip(starts, answers, strict=True)]
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
    """Atlas first; what lies in its undecided strip is solved, as far as the number of programs allows."""
    from safestart.certificates.survey import build

    hold = question.scenario.corridor.hold_radius
    cut = min(max(float(starts[:, 1].max()), hold + 1.0), MAX_RANGE)
    atlas = build(question, cut)
    lower, upper = atlas.bounds(starts[:, :2])
    answers, solved = [], 0
    for start, low, high in zip(starts, lower.tolist(), upper.tolist(), strict=True):
        if (low > 0.0 or high < 0.0) or solved >= MOST_PROGRAMS:
            answers.append(atlas.answer(start[:2]))
        else:
            answers.append(decide(question, start, verdict_only=True))
            solved += 1
        context.step(len(answers), len(starts), "starts")
    return answers


def _sentence(answer: Answer, horizon: float) -> str:
    if answer.verdict is Verdict.GO:
        return f"a thrust history keeps {answer.lower:.2f} m to every face for {horizon:g} s"
    if answer.verdict is Verdict.NO_GO:
        return (
            f"no thrust history stays for {horizon:g} s: the best ends {-answer.upper:.2f} m outside a face"
        )
    return f"undecided: {answer.reason}; margin between {answer.lower:.3g} and {answer.upper:.3g} m"


def _proof(question: Question, start: Floats, answer: Answer) -> dict[str, Any] | None:
    from safestart.certificates.prove import proof_of

    return None if answer.verdict is Verdict.UNDECIDED else proof_of(question, start, answer)

"""Verdicts for go-no-go with half-widths: proved for every parameter of the intervals and every start of the box."""

from __future__ import annotations

import math
from typing import Any

from safestart.errors import invalid
from safestart.exact.answer import Verdict
from safestart.exact.question import Question
from safestart.families.answer import Example, ForAll
from safestart.families.decide import decide_for_all
from safestart.families.members import Family
from safestart.families.prove import proof_for_all
from safestart.model.scenario import MAX_MEAN_MOTION, MIN_ACCELERATION, Floats, number
from safestart.processes.go_no_go.answer import Verdicts
from safestart.processes.go_no_go.question import held
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.processes.wire import finite
from safestart.runtime.progress import Context

MOST_FAMILIES = {"common": 50, "per_corner": 10}


def decide_families(inputs: GoNoGoInputs, question: Question, starts: Floats, context: Context) -> Verdicts:
    """Verdicts on the starts (S, 2 d), LVLH, with the members that differ, and proofs if asked for."""
    most = MOST_FAMILIES[inputs.witness]
    if len(starts) > most:
        raise invalid("states", f"at most {most} with half-widths and witness {inputs.witness}", len(starts))
    family = family_of(inputs, question)
    answers = []
    for k, start in enumerate(starts):
        answers.append(decide_for_all(family, start, witness=inputs.witness))
        context.step(k + 1, len(starts), "starts")
    return Verdicts(
        [answer.verdict.value for answer in answers],
        [finite(answer.margin_m) for answer in answers],
        [_sentence(answer, question) for answer in answers],
        examples=[[_member(example) for example in answer.examples] for answer in answers],
        proof=[
            None if answer.verdict is Verdict.UNDECIDED else proof_for_all(family, start, answer)
            for start, answer in zip(starts, answers, strict=True)
        ]
        if inputs.proofs
        else None,
        decided_by=[None if answer.verdict is Verdict.UNDECIDED else "families" for answer in answers],
    )


def family_of(inputs: GoNoGoInputs, question: Question) -> Family:
    """The family in SI units; raises ``InvalidInput`` under the field's name on the wire."""
    if not question.plain:
        raise invalid("question", "stay without a speed limit where half-widths are given", inputs.question)
    rate, motion = inputs.omega_t_deg_s, inputs.mean_motion_rad_s
    for name, room in (
        ("omega_t_half_width_deg_s", min(rate, 60.0 - rate)),
        ("a_max_half_width_m_s2", inputs.a_max_m_s2 - MIN_ACCELERATION),
        ("mean_motion_half_width_rad_s", min(motion, MAX_MEAN_MOTION - motion)),
    ):
        number(name, getattr(inputs, name), 0.0, room)
    d = question.dimensions
    return Family(
        question,
        math.radians(inputs.omega_t_half_width_deg_s),
        inputs.a_max_half_width_m_s2,
        inputs.mean_motion_half_width_rad_s,
        (inputs.position_half_width_m,) * d + (inputs.velocity_half_width_m_s,) * d,
    )


def _sentence(answer: ForAll, question: Question) -> str:
    horizon = question.horizon
    if answer.verdict is Verdict.UNDECIDED:
        return f"undecided: {answer.reason}"
    if answer.verdict is Verdict.NO_GO:
        return (
            f"whatever is true within the half-widths, no thrust {held(question)} stays for {horizon:g} s: each "
            f"history is at some time at least {-answer.margin_m:.2f} m outside a face"
        )
    kept = f"keeps {answer.margin_m:.2f} m to every face for {horizon:g} s, whatever is true within the half-widths"
    if answer.witness == "common":
        return f"one thrust history {kept}"
    return f"each corner of the start box has a thrust history that {kept}; each start between, their mixture"


def _member(example: Example) -> dict[str, Any]:
    target, chaser = example.question.scenario.target, example.question.scenario.chaser
    d = example.question.dimensions
    return {
        "verdict": example.answer.verdict.value,
        "margin_m": finite(example.answer.proved_m),
        "omega_t_deg_s": math.degrees(target.tumble_rate),
        "a_max_m_s2": chaser.max_acceleration,
        "mean_motion_rad_s": target.mean_motion,
        "position_m": example.start[:d].tolist(),
        "velocity_m_s": example.start[d:].tolist(),
    }

"""Answers with documents never contradict the certificate.

The exact question holds the thrust over steps of 2 s. A certified manoeuvre may need thrust that changes faster, and
then no thrust held so long stays, although the start is GO. Such a start stays GO: with the document of thrust held
over shorter steps where one stays, else with none, as the theorem needs none.
"""

from __future__ import annotations

from dataclasses import replace

from safestart.exact.answer import Answer, Verdict
from safestart.exact.decide import decide
from safestart.exact.prove import proof_of
from safestart.exact.question import MAX_STEPS, Question
from safestart.model.scenario import Floats
from safestart.processes.go_no_go import question as asked
from safestart.processes.go_no_go.answer import Verdicts
from safestart.processes.go_no_go.conditions import points_of
from safestart.processes.go_no_go.methods import certified
from safestart.processes.go_no_go.methods.proofs import in_lvlh
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.processes.wire import finite

SHORTER = (2, 4, 8)
"""Into how many parts the steps are cut, in turn."""


def agreeing(inputs: GoNoGoInputs, said: Verdicts) -> Verdicts:
    """``said``, the exact answers with documents, with every certified start GO."""
    if said.proof is None or said.decided_by is None or all(word == "GO" for word in said.verdict):
        return said
    points = points_of(inputs)
    question = asked.question_of(inputs, points.shape[-1])
    starts = in_lvlh(inputs, question, points)
    margins = list(said.margin_m)
    for k, one in enumerate(certified.certificates(inputs)):
        if not one.go or said.verdict[k] == "GO":
            continue
        said.verdict[k] = "GO"
        found = shorter(question, starts[k])
        if found is None:
            margins[k], said.reason[k] = one.margin, certified.sentence(one)
            said.proof[k], said.decided_by[k] = None, certified.NAME
            continue
        finer, answer = found
        margins[k] = finite(answer.margin_m)
        said.reason[k] = f"{asked.sentence(finer, answer)}, thrust {asked.held(finer)}"
        said.proof[k], said.decided_by[k] = proof_of(finer, starts[k], answer), "exact"
    return said._replace(margin_m=margins)


def shorter(question: Question, start: Floats) -> tuple[Question, Answer] | None:
    """The GO for thrust held over shorter steps, with its question; None where none is found."""
    for parts in SHORTER:
        if question.steps * parts > MAX_STEPS:
            return None
        finer = replace(question, dt=question.dt / parts, steps=question.steps * parts)
        answer = decide(finer, start)
        if answer.verdict is Verdict.GO:
            return finer, answer
    return None

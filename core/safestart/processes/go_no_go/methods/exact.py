"""Method exact: one cone program per start, proved either way."""

from __future__ import annotations

from safestart.errors import invalid
from safestart.exact.answer import TOLERANCE, Answer
from safestart.exact.decide import decide as decide_start
from safestart.exact.question import Question
from safestart.model.scenario import Floats
from safestart.processes.go_no_go.answer import Verdicts
from safestart.processes.go_no_go.conditions import Conditions
from safestart.processes.go_no_go.methods.proofs import MOST_PROGRAMS, Solved, prove
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.runtime.progress import Context


def decide(inputs: GoNoGoInputs, _: Conditions, context: Context) -> Verdicts:
    """At most ``MOST_PROGRAMS`` starts."""
    if len(inputs.states) > MOST_PROGRAMS:
        raise invalid(
            "states", f"at most {MOST_PROGRAMS} with method exact; auto takes more", len(inputs.states)
        )
    return prove(inputs, one_by_one, context)


def one_by_one(question: Question, starts: Floats, context: Context, tolerance: float = TOLERANCE) -> Solved:
    """The exact answer for each start (S, 2 d), its margin to ``tolerance`` (m)."""
    answers: list[Answer] = []
    for k, start in enumerate(starts):
        answers.append(decide_start(question, start, tolerance=tolerance))
        context.step(k + 1, len(starts), "starts")
    return answers, ["exact"] * len(answers)

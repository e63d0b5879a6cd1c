"""go-no-go against a bounded disturbance: the tube's answers, and their proofs."""

from __future__ import annotations

from safestart.disturbance.tube import Disturbance, decide_disturbed
from safestart.errors import invalid
from safestart.exact.answer import Answer, Verdict
from safestart.exact.question import Question
from safestart.model.scenario import Floats
from safestart.processes.go_no_go.question import held
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.runtime.progress import Context


def disturbance_of(inputs: GoNoGoInputs) -> Disturbance | None:
    """The disturbance that the start must withstand; None when the question has none."""
    found = Disturbance(inputs.disturbance_m_s2, inputs.start_error_m, inputs.start_error_m_s)
    return found if found.vector().any() else None


def decide(disturbance: Disturbance, question: Question, starts: Floats, context: Context) -> list[Answer]:
    """One answer per start."""
    if not question.plain:
        raise invalid(
            "disturbance_m_s2", "question stay without a speed limit: the tube covers no other", question.kind
        )
    answers = []
    for k, start in enumerate(starts):
        answers.append(decide_disturbed(question, start, disturbance))
        context.step(k + 1, len(starts), "starts")
    return answers


def sentence(disturbance: Disturbance, question: Question, answer: Answer) -> str:
    """The verdict in words."""
    span = f"{question.horizon:g} s"
    if answer.verdict is Verdict.GO:
        return (
            f"{_bound(disturbance)} a plan with feedback keeps {answer.lower:.2f} m to every face for {span}"
        )
    if answer.verdict is Verdict.NO_GO:
        short = f"{-answer.upper:.2f} m"
        return (
            f"even undisturbed no thrust {held(question)} stays for {span}: each history is at some time at least "
            f"{short} outside a face"
        )
    return f"undecided: {answer.reason}"


def _bound(disturbance: Disturbance) -> str:
    parts = [f"every disturbance up to {disturbance.acceleration:g} m/s^2"]
    if disturbance.position or disturbance.velocity:
        parts.append(f"start error up to {disturbance.position:g} m and {disturbance.velocity:g} m/s")
    return "against " + " and ".join(parts)

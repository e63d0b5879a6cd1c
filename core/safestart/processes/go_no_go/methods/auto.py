"""Method auto: the verdicts of ``exact``, by an atlas where there is one or where many starts make one pay."""

from __future__ import annotations

from safestart.errors import invalid
from safestart.exact.answer import Answer
from safestart.exact.decide import decide as decide_start
from safestart.exact.question import Question
from safestart.model.scenario import Floats, Rest
from safestart.processes.go_no_go.answer import Verdicts
from safestart.processes.go_no_go.atlases import atlas_for
from safestart.processes.go_no_go.conditions import Conditions
from safestart.processes.go_no_go.cost import MANY
from safestart.processes.go_no_go.methods.exact import one_by_one
from safestart.processes.go_no_go.methods.proofs import MOST_PROGRAMS, prove
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.runtime.progress import Context

"""Starts from which on building an atlas (some tens of cone programs) pays."""


def decide(inputs: GoNoGoInputs, _: Conditions, context: Context) -> Verdicts:
    """Atlases know planar starts at rest in LVLH, asked to stay; the others are solved one by one."""

    def solve(question: Question, starts: Floats, context: Context) -> list[Answer]:
        if question.plain and question.dimensions == 2 and inputs.rest is Rest.LVLH:
            return _by_atlas(question, starts, context)
        if len(starts) > MOST_PROGRAMS:
            raise invalid(
                "states", f"at most {MOST_PROGRAMS} in space or at rest in the body frame", len(starts)
            )
        return one_by_one(question, starts, context)

    return prove(inputs, solve, context)


def _by_atlas(question: Question, starts: Floats, context: Context) -> list[Answer]:
    """Atlas first; what lies in its undecided strip is solved, as far as the number of programs allows.

    Few starts ask an atlas that is there and are solved otherwise; many have one built.
    """
    many = len(starts) >= MANY
    atlas = atlas_for(question, float(starts[:, 1].max()), context, make=many)
    if atlas is None:
        return one_by_one(question, starts, context)
    lower, upper = atlas.bounds(starts[:, :2])
    answers, solved = [], 0
    for start, low, high in zip(starts, lower.tolist(), upper.tolist(), strict=True):
        if low > 0.0 or high < 0.0 or solved >= MOST_PROGRAMS:
            answers.append(atlas.answer(start[:2]))
        else:
            answers.append(decide_start(question, start, verdict_only=many))
            solved += 1
        context.step(len(answers), len(starts), "starts")
    return answers

"""Method auto: ``certified`` if it says GO, else ``exact``, or an atlas where many starts pay for one."""

from __future__ import annotations

import math
from typing import Any

from safestart.errors import invalid
from safestart.exact.answer import GUARD, Answer, Verdict
from safestart.exact.decide import decide as decide_start
from safestart.exact.question import Question
from safestart.model.scenario import Floats, Rest
from safestart.processes.go_no_go.answer import Verdicts
from safestart.processes.go_no_go.atlases import atlas_for
from safestart.processes.go_no_go.conditions import Conditions
from safestart.processes.go_no_go.cost import MANY
from safestart.processes.go_no_go.methods import certified
from safestart.processes.go_no_go.methods.agreement import agreeing
from safestart.processes.go_no_go.methods.exact import one_by_one
from safestart.processes.go_no_go.methods.proofs import MOST_PROGRAMS, Solved, prove
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.runtime.progress import Context


def decide(inputs: GoNoGoInputs, _: Conditions, context: Context) -> Verdicts:
    """The certificate's GOs stand; the other starts, and questions outside the certificate, go to the proving
    methods."""
    if inputs.proofs and certified.covers(inputs):
        return agreeing(inputs, prove_all(inputs, context))
    if not certified.answers(inputs):
        return prove_all(inputs, context)
    found = certified.certificates(inputs)
    left = [k for k, one in enumerate(found) if not one.go]
    if len(left) == len(found):
        return prove_all(inputs, context)
    said = Verdicts(
        ["GO"] * len(found),
        [one.margin for one in found],
        [certified.sentence(one) for one in found],
        decided_by=[certified.NAME] * len(found),
    )
    if left:
        others = inputs.model_copy(update={"states": [inputs.states[k] for k in left]})
        _put(said, left, prove_all(others, context))
    return said


def prove_all(inputs: GoNoGoInputs, context: Context) -> Verdicts:
    """Atlases cover planar starts at rest in LVLH and the question `stay`; others are solved one by one."""

    def solve(question: Question, starts: Floats, context: Context) -> Solved:
        if question.plain and question.dimensions == 2 and inputs.rest is Rest.LVLH:
            return _by_atlas(question, starts, context, documents=inputs.proofs)
        if len(starts) > MOST_PROGRAMS:
            raise invalid(
                "states",
                f"at most {MOST_PROGRAMS} in space or at rest in the body frame that certified leaves open; method "
                "certified takes more",
                len(starts),
            )
        return one_by_one(question, starts, context)

    return prove(inputs, solve, context)


def _put(said: Verdicts, places: list[int], found: Verdicts) -> None:
    """Write the answers on some starts into the answers on all."""
    pairs: tuple[tuple[Any, Any], ...] = (
        (said.verdict, found.verdict),
        (said.margin_m, found.margin_m),
        (said.reason, found.reason),
        (said.decided_by, found.decided_by),
    )
    for column, values in pairs:
        for k, value in zip(places, values, strict=True):
            column[k] = value


def _by_atlas(question: Question, starts: Floats, context: Context, *, documents: bool) -> Solved:
    """Ask an atlas and solve starts in its undecided strip, up to the limit on programs.

    Few starts are solved: their margins do not depend on the atlases that the store happens to hold. Thrust and
    multipliers are collected only for ``documents``.
    """
    if len(starts) < MANY:
        return one_by_one(question, starts, context)
    atlas = atlas_for(question, float(starts[:, 1].max()), context)
    lower, upper = atlas.bounds(starts[:, :2])
    answers: list[Answer] = []
    by: list[str] = []
    solved = 0
    for start, low, high in zip(starts, lower.tolist(), upper.tolist(), strict=True):
        if low > 0.0 or high < 0.0 or solved >= MOST_PROGRAMS:
            bare = None if documents else _bare(low, high)
            answers.append(bare or atlas.answer(start[:2]))
            by.append("atlas")
        else:
            answers.append(decide_start(question, start, verdict_only=True))
            by.append("exact")
            solved += 1
        context.step(len(answers), len(starts), "starts")
    return answers, by


def _bare(low: float, high: float) -> Answer | None:
    """The atlas's answer from its bounds, without thrust or multipliers; None where they are too near to 0 to tell."""
    if high < -GUARD:
        return Answer(Verdict.NO_GO, high, -math.inf, high, None, (), 0)
    return Answer(Verdict.GO, low, low, high, None, (), 0) if low > GUARD else None

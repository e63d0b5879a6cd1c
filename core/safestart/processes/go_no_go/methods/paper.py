"""Method paper: the conditions of paper 000 decide. They are not sound: GO is not a proof, NO_GO means not
certified."""

from __future__ import annotations

from safestart.closed_form.explain import sentence
from safestart.processes.go_no_go.answer import Verdicts
from safestart.processes.go_no_go.conditions import Conditions
from safestart.processes.go_no_go.methods.plain import refuse_more
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.runtime.progress import Context


def decide(inputs: GoNoGoInputs, conditions: Conditions, context: Context) -> Verdicts:
    """A start is GO when its smallest margin is positive."""
    refuse_more(inputs)
    context.step(1, 1)
    return Verdicts(
        ["GO" if margin > 0.0 else "NO_GO" for margin in conditions.margin],
        conditions.margin,
        [
            sentence(*start)
            for start in zip(
                conditions.binding,
                conditions.violated,
                conditions.range_margin,
                conditions.margin,
                strict=True,
            )
        ],
        decided_by=["paper"] * len(conditions.margin),
    )

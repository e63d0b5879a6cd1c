"""An example method of go-no-go: the paper's conditions with a metre in reserve."""

from __future__ import annotations

from safestart.processes.go_no_go.answer import Verdicts
from safestart.processes.go_no_go.conditions import Conditions
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.runtime.progress import Context

RESERVE_M = 1.0


def decide(_: GoNoGoInputs, conditions: Conditions, context: Context) -> Verdicts:
    """A start is GO where it meets the conditions with more than ``RESERVE_M`` to spare."""
    margin = [value - RESERVE_M for value in conditions.margin]
    context.step(1, 1)
    return Verdicts(
        ["GO" if value > 0.0 else "NO_GO" for value in margin],
        margin,
        [
            f"{value:.2f} m beyond a reserve of {RESERVE_M:g} m at {binding}"
            for value, binding in zip(margin, conditions.binding, strict=True)
        ],
    )

"""Method closed_form: the paper's conditions decide. GO is no proof, and NO_GO means not certified."""

from __future__ import annotations

from safestart.closed_form.explain import sentence
from safestart.errors import invalid
from safestart.processes.go_no_go.answer import Verdicts
from safestart.processes.go_no_go.conditions import Conditions
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.processes.go_no_go.uncertainty import HALF_WIDTHS
from safestart.runtime.progress import Context

_UNKNOWN = frozenset(
    {
        "question",
        "speed_limit_m_s",
        "keep_out_m",
        "disturbance_m_s2",
        "start_error_m",
        "start_error_m_s",
        *HALF_WIDTHS,
    }
)
"""Inputs of which the closed form knows the default only, which asks for nothing."""


def decide(inputs: GoNoGoInputs, conditions: Conditions, context: Context) -> Verdicts:
    """A start is GO where its smallest margin is positive."""
    if not _UNKNOWN.isdisjoint(inputs.model_fields_set):
        _refuse(inputs)
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
    )


def _refuse(inputs: GoNoGoInputs) -> None:
    for name in GoNoGoInputs.model_fields:
        if name in _UNKNOWN and getattr(inputs, name) != GoNoGoInputs.model_fields[name].default:
            raise invalid(
                "method",
                f"exact or auto where {name} is given: the closed form does not know it",
                inputs.method,
            )

"""Method closed_form: the paper's conditions decide. GO is not a proof, and NO_GO means not certified."""

from __future__ import annotations

from safestart.closed_form.explain import sentence
from safestart.errors import invalid
from safestart.processes.go_no_go.answer import Verdicts
from safestart.processes.go_no_go.conditions import Conditions
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.processes.wire import ScenarioInput
from safestart.runtime.progress import Context

_TAKEN = frozenset(
    {
        *ScenarioInput.model_fields,
        *("states", "rest", "method", "proofs"),
        # Details of refused questions, and the time, on which the conditions do not depend.
        *(
            "horizon_s",
            "within_s",
            "hold_x_m",
            "hold_y_m",
            "hold_z_m",
            "ball_radius_m",
            "rest_speed_m_s",
            "witness",
        ),
    }
)
"""Supported inputs; any other input must have its default value, which asks for nothing."""


def decide(inputs: GoNoGoInputs, conditions: Conditions, context: Context) -> Verdicts:
    """A start is GO when its smallest margin is positive."""
    if not inputs.model_fields_set <= _TAKEN:
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
    for name, field in GoNoGoInputs.model_fields.items():
        if name not in _TAKEN and getattr(inputs, name) != field.default:
            raise invalid(
                "method",
                f"exact or auto where {name} is given: the closed form does not know it",
                inputs.method,
            )

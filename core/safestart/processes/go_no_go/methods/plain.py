"""The questions that the closed forms cover: `stay`, nominal and undisturbed."""

from __future__ import annotations

from safestart.errors import invalid
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.processes.wire import ScenarioInput

KNOWN = frozenset(
    {
        *ScenarioInput.model_fields,
        *("states", "rest", "method", "proofs"),
        # Details of refused questions, and the time, which a closed form does not have or takes as for ever.
        *(
            "horizon_s",
            "within_s",
            "hold_x_m",
            "hold_y_m",
            "hold_z_m",
            "ball_radius_m",
            "rest_speed_m_s",
            "after_arrival",
            "witness",
        ),
    }
)
"""Supported inputs; any other input must have its default value."""


def more_asked(inputs: GoNoGoInputs) -> str | None:
    """The first input that a closed form does not cover; None if it covers all."""
    if inputs.model_fields_set <= KNOWN:
        return None
    for name, field in GoNoGoInputs.model_fields.items():
        if name not in KNOWN and getattr(inputs, name) != field.default:
            return name
    return None


def refuse_more(inputs: GoNoGoInputs) -> None:
    """Raise ``InvalidInput`` if a closed form does not cover the question."""
    name = more_asked(inputs)
    if name is not None:
        raise invalid(
            "method", f"exact or auto where {name} is given: no closed form knows it", inputs.method
        )

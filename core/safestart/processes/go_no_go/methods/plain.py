"""What the closed forms know of a question: to stay, nominal and undisturbed, without more."""

from __future__ import annotations

from safestart.errors import invalid
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.processes.wire import ScenarioInput

KNOWN = frozenset(
    {
        *ScenarioInput.model_fields,
        *("states", "rest", "method", "proofs"),
        # Details of questions that are refused themselves, and the time: a closed form has none, or says for ever.
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
"""Inputs that may be given; every other one asks for more unless it is the default."""


def more_asked(inputs: GoNoGoInputs) -> str | None:
    """The first input that asks for more than a closed form knows; None where there is none."""
    if inputs.model_fields_set <= KNOWN:
        return None
    for name, field in GoNoGoInputs.model_fields.items():
        if name not in KNOWN and getattr(inputs, name) != field.default:
            return name
    return None


def refuse_more(inputs: GoNoGoInputs) -> None:
    """Raise ``InvalidInput`` where more is asked than a closed form knows."""
    name = more_asked(inputs)
    if name is not None:
        raise invalid(
            "method", f"exact or auto where {name} is given: no closed form knows it", inputs.method
        )

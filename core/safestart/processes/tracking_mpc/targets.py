"""Tumbling targets that people know, as inputs of tracking-mpc: paper 002's Envisat and three further ones."""

from __future__ import annotations

from typing import Any

TARGETS: dict[str, dict[str, Any]] = {
    "Envisat": {},
    "Envisat, 5 deg/s near z": {"body_rate_deg_s": [0.0, 0.06, 5.0]},
    "rocket body, 6 deg/s": {
        "inertia_kg_m2": [[70_000, 0, 0], [0, 4_500, 0], [0, 0, 71_500]],
        "body_rate_deg_s": [6.0, 0.4, 0.3],
    },
    "nearly axisymmetric": {
        "inertia_kg_m2": [[900, 0, 0], [0, 905, 0], [0, 0, 1_200]],
        "body_rate_deg_s": [1.0, 0.5, 4.0],
    },
}
"""What differs from the defaults, which are Envisat as in the paper's Table I."""


def presets(defaults: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Whole questions for a form, by name: the target of each, the controller and the region of ``defaults``."""
    return {name: {**defaults, **target} for name, target in TARGETS.items()}

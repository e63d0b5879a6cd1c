"""A question whose plan is in a file, as the same question with start and burns."""

from __future__ import annotations

import math
from typing import Any

from safestart.errors import invalid, named
from safestart.missed_burn.plan_file import plan_in_message
from safestart.missed_burn.plan_text import Filed, burns_in_csv, is_message
from safestart.processes.passive_abort.question import with_plan
from safestart.processes.passive_abort.spec import PassiveAbortInputs

_ROUND = 1e-3
"""Eccentricity from which a circular model leaves something out that is worth saying."""


def resolved(inputs: PassiveAbortInputs) -> tuple[PassiveAbortInputs, dict[str, Any] | None]:
    """The inputs with start and burns, and ``ReadOutput`` where they come from a file; raises ``InvalidInput``."""
    if inputs.plan is None:
        return inputs, None
    told = read(inputs.plan, inputs.target)
    more: dict[str, Any] = {}
    if told.start is not None:
        start = told.start.tolist()
        more["start"] = {"position_m": start[:3], "velocity_m_s": start[3:]}
    elements = None if told.target is None else _elements(told)
    if elements is not None:
        named = elements if inputs.model == "earth" else {"semi_major_axis_m": elements["semi_major_axis_m"]}
        more |= named
    asked = with_plan(inputs, told.burns, more)
    assert asked.start is not None
    assert asked.burns is not None
    unknown: dict[str, Any] = dict.fromkeys(
        ("eccentricity", "inclination_deg", "argument_of_perigee_deg", "true_anomaly_deg")
    )
    kept = {"start": asked.start.model_dump(), "burns": [burn.model_dump() for burn in asked.burns]}
    return asked, {**kept, "semi_major_axis_m": asked.semi_major_axis_m, **unknown, **(elements or {})}


def read(plan: str, target: str | None) -> Filed:
    """The file's burns; raises ``InvalidInput``."""
    if not is_message(plan):
        if target is not None:
            raise invalid("target", "none beside a plan in CSV, which is in LVLH", "a file")
        return named("plan", burns_in_csv, plan)
    if target is None:
        raise invalid("target", "the target's OEM, OPM or OCM beside a plan from a message", "none")
    return plan_in_message(plan.encode(), target.encode())


def left_out(inputs: PassiveAbortInputs, filed: dict[str, Any] | None) -> list[str]:
    """What a circular model leaves out of a target's orbit from a file."""
    shape = None if filed is None else filed["eccentricity"]
    if shape is None or inputs.model == "earth" or shape < _ROUND:
        return []
    return [
        f"The target's orbit has the eccentricity {shape:.4g}, and model {inputs.model} takes it as a circle: ask with "
        "model earth."
    ]


def _elements(told: Filed) -> dict[str, float]:
    assert told.target is not None
    one = told.target
    return {
        "semi_major_axis_m": one.semi_major_axis,
        "eccentricity": one.eccentricity,
        "inclination_deg": math.degrees(one.inclination),
        "argument_of_perigee_deg": math.degrees(one.perigee),
        "true_anomaly_deg": math.degrees(one.anomaly),
    }

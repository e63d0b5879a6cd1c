"""Run safe-abort-map: the proofs of one shard's starts; the map of all of them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from safestart.campaign.case import Case
from safestart.campaign.part import Part
from safestart.errors import InvalidInput
from safestart.passive_safety.abort_map import safe_until
from safestart.passive_safety.question import Question
from safestart.processes.base import ProcessOutput
from safestart.processes.passive_safety.system import system_of
from safestart.processes.plotting import npz
from safestart.processes.safe_abort_map.plots import arrays, map_picture
from safestart.processes.safe_abort_map.spec import SafeAbortMapInputs
from safestart.processes.safe_abort_map.study import place, study_of, summary
from safestart.runtime.progress import Context

INSIDE = "not wholly outside the guard"


def shard(part: dict[str, Any], context: Context) -> Part:
    """The limits of the part's starts."""
    inputs = SafeAbortMapInputs.model_validate(part["inputs"])
    return study_of(inputs).simulated(part, partial(limits, inputs), context, "start")


def limits(inputs: SafeAbortMapInputs, case: Case, context: Context) -> dict[str, Any]:
    """Both limits of a start, minutes; None inside the guard."""
    question = _question(inputs, *place(dict(case.parameters)))
    if question is None:
        return {"safe_abort_until_min": None, "all_proved_until_min": None, "reason": INSIDE}
    until = safe_until(question, inputs.windows, Context(cancelled=context.cancelled))
    return {
        "safe_abort_until_min": until.separation,
        "all_proved_until_min": until.requirements,
        "reason": until.reason or None,
    }


def merge(inputs: SafeAbortMapInputs, parts: Sequence[Part], context: Context) -> ProcessOutput:
    """The map as a document, a picture and arrays."""
    document = summary(inputs, [part.document for part in parts])
    context.step(0, 1, "picture")
    return ProcessOutput(document, (map_picture(inputs, document), npz("map.npz", arrays(document))))


def _question(inputs: SafeAbortMapInputs, x: float, y: float) -> Question | None:
    half = inputs.half_width_m
    last = inputs.last_abort_min
    horizon = last + inputs.drift_min
    system = system_of(inputs)
    try:
        return Question(
            (x, y, 0.0, 0.0), (half, half, 0.0, 0.0), horizon, (0.0, last), inputs.box_half_width_m, system
        )
    except InvalidInput as error:
        if error.field == "centre":
            return None
        raise

"""Run safe-abort-map: the proofs of one shard's starts; the map of all of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from safestart.errors import InvalidInput
from safestart.passive_safety.abort_map import safe_until
from safestart.passive_safety.question import Question
from safestart.processes.base import ProcessOutput
from safestart.processes.passive_safety.system import system_of
from safestart.processes.plotting import npz
from safestart.processes.safe_abort_map.parts import summary
from safestart.processes.safe_abort_map.plots import arrays, map_picture
from safestart.processes.safe_abort_map.spec import SafeAbortMapInputs
from safestart.processes.sharding import Part
from safestart.runtime.progress import Context

INSIDE = "not wholly outside the guard"


def shard(part: dict[str, Any], context: Context) -> Part:
    """Rows (x, y, separation, requirements, reason) of the part's starts; minutes, None inside the guard."""
    inputs = SafeAbortMapInputs.model_validate(part["common"])
    rows: list[list[Any]] = []
    count = len(part["places"])
    quiet = Context(cancelled=context.cancelled)
    for x, y in part["places"]:
        context.step(len(rows), count, f"start {len(rows) + 1} of {count}")
        question = _question(inputs, x, y)
        if question is None:
            rows.append([x, y, None, None, INSIDE])
            continue
        until = safe_until(question, inputs.windows, quiet)
        rows.append([x, y, until.separation, until.requirements, until.reason])
    return Part({"starts": rows})


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

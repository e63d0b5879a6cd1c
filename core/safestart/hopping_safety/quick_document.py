"""The proof document of an approach's hops, from the proof in NumPy; its checker repeats every bound with balls."""

from __future__ import annotations

from typing import Any

from safestart.hopping.approach import Approach
from safestart.hopping_safety.quick_proof import Bounds
from safestart.missed_burn.plan import Errors, Plan, Question
from safestart.missed_burn.question_document import sealed


def document_of(
    plan: Approach, keep_out: float, horizon: float, errors: Errors, begun: Bounds, found: list[Bounds]
) -> dict[str, Any]:
    """The document (schema ``safestart-abort-proof/1``) of hops that are all proved; ``begun`` is of the drift from the
    start, ``found`` of those after each hop's impulse. The stop at the hold point is no burn of it."""
    flight = Plan.of(
        plan.mean_motion, plan.states()[0].tolist(), plan.times[:-1].tolist(), plan.impulses[:-1]
    )
    named = [("start", -1, begun), *(("made", k, bounds) for k, bounds in enumerate(found))]
    cases = [
        {"kind": kind, "burn": burn, "first_s": 0.0, "last_s": 0.0, "cells": bounds.cells.tolist()}
        for kind, burn, bounds in named
    ]
    least = min(bounds.least for _, _, bounds in named)
    return sealed(Question(flight, keep_out, horizon, errors), least, cases)

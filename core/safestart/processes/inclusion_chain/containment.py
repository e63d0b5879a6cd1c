"""The horizon from which every certified start is in another set, and the certified starts that cannot stay."""

from __future__ import annotations

from typing import Any

import numpy as np

from safestart.atlas.atlas import Atlas
from safestart.atlas.survey import build
from safestart.closed_form.by_name import ClosedForm, map_of
from safestart.engines.exact import containment_horizon
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.model.scenario import Floats, Grid
from safestart.processes.inclusion_chain.evidence import proof_at
from safestart.processes.inclusion_chain.regions import question_of, state_at
from safestart.processes.inclusion_chain.spec import ChainInputs
from safestart.processes.wire import DT_S
from safestart.runtime.progress import Context

_FINE = 401
FORMS: dict[str, ClosedForm] = {"certified": "certified", "analytical": "paper"}
"""Closed forms by the name of their set."""


def fine_atlas(inputs: ChainInputs) -> Atlas:
    """Which starts can stay for the horizon, for :func:`sliver`."""
    return build(question_of("stay", inputs), inputs.grid.y_max_m)


def in_synchronize(inputs: ChainInputs, inner: str, starts: Floats, context: Context) -> dict[str, Any]:
    """Smallest horizon at which `synchronize` is GO for every start (P, 2); its end is free, so the set grows.

    Each start is tried at the horizon that the earlier ones needed and bisected only if it fails there; the farthest
    starts come first, as they need the longest.
    """
    last = round(inputs.containment_up_to_s / DT_S)
    ordered = starts[np.argsort(-np.hypot(starts[:, 0], starts[:, 1]), kind="stable")]
    needed, decides, never = 1, None, []
    for k, start in enumerate(ordered):
        context.step(k, len(ordered), "starts")
        if _arrives(inputs, start, needed):
            continue
        if not _arrives(inputs, start, last):
            never.append(start)
            continue
        low, needed, decides = needed, last, start
        while needed - low > 1:
            middle = (low + needed) // 2
            low, needed = (low, middle) if _arrives(inputs, start, middle) else (middle, needed)
    shown = never[0] if never else decides
    contained = len(ordered) > 0 and not never
    return {
        "inner": inner,
        "outer": "synchronize",
        "horizon_s": needed * DT_S if contained else None,
        "up_to_s": inputs.containment_up_to_s,
        "cells_never": len(never) if len(ordered) else None,
        **_place(shown),
        "proof": proof_at(question_of("synchronize", inputs, last), never[0]) if never else None,
    }


def in_exact_position(inputs: ChainInputs, inner: str, starts: Floats) -> dict[str, Any]:
    """First horizon from ``horizon_s`` on at which the exact fixed-time position set holds every start."""
    bound = inputs.containment_up_to_s
    found = None
    if len(starts) and bound >= inputs.horizon_s:
        found = containment_horizon(inputs.scenario(), starts, dt=DT_S, bound=bound, start=inputs.horizon_s)
    return {
        "inner": inner,
        "outer": "exact_position",
        "horizon_s": found,
        "up_to_s": bound,
        "cells_never": None,
        **_place(None),
        "proof": None,
    }


def sliver(inputs: ChainInputs, inner: str, atlas: Atlas) -> dict[str, Any]:
    """Starts of a 401 x 401 grid that a closed form certifies and an atlas proves unable to stay for the horizon."""
    scenario = inputs.scenario()
    grid = Grid(_FINE, _FINE, inputs.grid.y_max_m)
    mask = map_of(FORMS[inner], scenario, grid).mask
    starts = grid.points(scenario.corridor)[mask]
    question = question_of("stay", inputs)
    upper = atlas.bounds(starts)[1] if len(starts) else np.empty(0)
    gone = upper < 0.0
    worst = starts[int(np.argmin(upper))] if gone.any() else None
    return {
        "inner": inner,
        "certified": len(starts),
        "cannot_stay": int(gone.sum()),
        **_place(worst),
        "margin_m": float(upper.min()) if gone.any() else None,
        "proof": None if worst is None else proof_at(question, worst),
    }


def _arrives(inputs: ChainInputs, start: Floats, steps: int) -> bool:
    question = question_of("synchronize", inputs, steps)
    return decide(question, state_at(start), verdict_only=True).verdict is Verdict.GO


def _place(start: Floats | None) -> dict[str, float | None]:
    return {"x_m": None, "y_m": None} if start is None else {"x_m": float(start[0]), "y_m": float(start[1])}

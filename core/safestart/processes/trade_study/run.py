"""One operating point of a trade study, and the maps of all."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from safestart.atlas.survey import build
from safestart.campaign.case import Case
from safestart.campaign.part import Part
from safestart.closed_form.by_name import go_of
from safestart.constraints.corridor import corridor_of
from safestart.control.forecast import flight_plan
from safestart.control.gains import preset
from safestart.exact.question import Question
from safestart.model.metrics import ratio
from safestart.model.scenario import Chaser, Rest, Scenario, Target
from safestart.processes.base import ProcessOutput
from safestart.processes.trade_study.plots import heat_maps
from safestart.processes.trade_study.spec import TradeStudyInputs
from safestart.processes.trade_study.study import area, study_of, summary
from safestart.processes.wire import DT_S
from safestart.runtime.progress import Context
from safestart.simulation.compiled_loop import fly
from safestart.simulation.noise import CONTINUOUS, Truth
from safestart.simulation.starts import start_states


def shard(part: dict[str, Any], context: Context) -> Part:
    """One operating point."""
    inputs = TradeStudyInputs.model_validate(part["inputs"])
    return study_of(inputs).simulated(part, partial(operating_point, inputs), context, "operating point")


def operating_point(inputs: TradeStudyInputs, case: Case, context: Context) -> dict[str, Any]:
    """What ``TradePoint`` describes."""
    omega, a_max = case.parameters["omega_t_deg_s"], case.parameters["a_max_m_s2"]
    target = Target(math.radians(omega), inputs.mean_motion_rad_s)
    shape, grid = inputs.corridor.shape(), inputs.grid.grid()
    scenario = Scenario(target, Chaser(a_max), shape)
    steps = round(inputs.horizon_s / DT_S)
    points = grid.points(shape)
    points = points[corridor_of(shape).contains(points)]
    context.step(0, 2, "flights")
    flights = fly(
        flight_plan(scenario, preset(inputs.preset), DT_S, steps),
        start_states(scenario, points, Rest.LVLH),
        Truth(CONTINUOUS),
    )
    certified = go_of(inputs.certificate, scenario, points)
    paper = go_of("paper", scenario, points)
    context.step(1, 2, "atlas")
    atlas = build(Question(scenario, DT_S, steps), inputs.grid.y_max_m)
    impulse = flights.delta_v[flights.safe]
    return {
        "omega_t_deg_s": omega,
        "a_max_m_s2": a_max,
        "certified_fraction": float(certified.mean()),
        "paper_fraction": float(paper.mean()),
        "exact_inner_m2": float(atlas.inner_area),
        "exact_outer_m2": float(atlas.outer_area),
        "exact_fraction": None if atlas.message else float(atlas.inner_area) / area(inputs),
        "flown_fraction": float(flights.safe.mean()),
        "certified_flown": ratio(int((certified & flights.safe).sum()), int(certified.sum())),
        "mean_delta_v_m_s": float(np.mean(impulse)) if len(impulse) else None,
        "message": atlas.message,
    }


def merge(inputs: TradeStudyInputs, parts: Sequence[Part], context: Context) -> ProcessOutput:
    """All points and their heat maps."""
    document = summary(inputs, [part.document for part in parts])
    context.step(0, 1, "picture")
    return ProcessOutput(document, (heat_maps(inputs, document["points"]),))

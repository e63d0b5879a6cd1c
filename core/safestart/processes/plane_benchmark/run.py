"""Run plane-benchmark: every engine on one plane, then the comparison."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from safestart.engines.base import EngineResult
from safestart.engines.registry import engine_spec
from safestart.engines.space.problem import PlaneProblem, engine_in_space
from safestart.model.metrics import iou, ratio, violation
from safestart.processes.base import ProcessOutput
from safestart.processes.plane_benchmark.plots import overlay
from safestart.processes.plane_benchmark.spec import PlaneBenchmarkInputs
from safestart.processes.plotting import npz
from safestart.processes.start_in_space.plane import plane_of
from safestart.processes.start_in_space.question import stay_in
from safestart.runtime.progress import Context

_FINISH = 1.0


def run(inputs: PlaneBenchmarkInputs, context: Context) -> ProcessOutput:
    """Solve, compare, draw. A failed engine keeps its row, with its code and reason and without measures."""
    question = stay_in(inputs, inputs.horizon_s)
    problem = PlaneProblem(
        question,
        plane_of(inputs.plane, question),
        inputs.across,
        inputs.along,
        (inputs.position_sigma_m, inputs.velocity_sigma_m_s),
        inputs.seed,
    )
    total, done = sum(engine_spec(name).share for name in inputs.engines) + _FINISH, 0.0
    results: dict[str, EngineResult] = {}
    inside = problem.inside()
    for name in inputs.engines:
        share = engine_spec(name).share
        found = engine_in_space(name).solve(problem, context.part(done, share, total, name))
        results[name] = found.fit(name, inside)
        done += share
        context.step(done, total, f"{name} done")
    a, b, _ = problem.plane.grid(problem.across, problem.along)
    cell = float((a[1] - a[0]) * (b[1] - b[0]))
    arrays: dict[str, Any] = {"x_m": a, "y_m": b, "inside": inside}
    for name, result in results.items():
        if result.mask is not None:
            arrays[f"{name}_mask"] = result.mask
        if result.margin is not None:
            arrays[f"{name}_margin_m"] = result.margin
    document = {
        "inside_cells": int(np.count_nonzero(inside)),
        "cell_area": cell,
        "axes": list(inputs.plane.labels()),
        "rows": [_row(name, result, cell, results) for name, result in results.items()],
    }
    picture = overlay(inputs.plane.labels(), (a, b), inside, results)
    return ProcessOutput(document, (picture, npz("maps.npz", arrays)))


def _row(name: str, result: EngineResult, cell: float, results: Mapping[str, EngineResult]) -> dict[str, Any]:
    mask, reference = result.mask, results.get("exact")
    exact = None if reference is None else reference.mask
    count = None if mask is None else int(np.count_nonzero(mask))
    row: dict[str, Any] = {
        "engine": name,
        "code": result.code.value,
        "message": result.message,
        "cells": count,
        "area": None if count is None else cell * count,
        "area_ratio_vs_exact": None,
        "iou_vs_exact": None,
        "violation_vs_exact": None,
        "run_s": result.run_s,
        "detail": dict(result.detail),
    }
    if mask is not None and exact is not None:
        row["area_ratio_vs_exact"] = ratio(int(np.count_nonzero(mask)), int(np.count_nonzero(exact)))
        row["iou_vs_exact"], row["violation_vs_exact"] = iou(mask, exact), violation(mask, exact)
    return row

"""Run benchmark: every chosen engine on one problem, then the comparison (paper 000, Table 2)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from safestart.engines.base import EngineResult, Problem
from safestart.engines.exact import containment_horizon
from safestart.engines.load import engine
from safestart.engines.registry import engine_spec
from safestart.model.metrics import ConfusionMatrix, iou, ratio, violation
from safestart.model.scenario import Bools
from safestart.papers.safe_start import TABLE2, TABLE2_THRUST_M_S2
from safestart.processes.base import Artifact, ProcessOutput
from safestart.processes.benchmark.notes import notes
from safestart.processes.benchmark.plots import agreement_panels, overlay_map
from safestart.processes.benchmark.spec import BenchmarkQuestion
from safestart.processes.output import Undrawn
from safestart.processes.plotting import npz
from safestart.processes.wire import DT_S
from safestart.runtime.progress import Context

_FINISH = 3.0
"""Share of the progress bar for measures and pictures; an engine's is in its spec."""


def problem_of(inputs: BenchmarkQuestion) -> Problem:
    """The engines' problem in SI units."""
    return Problem(inputs.scenario(), inputs.grid.grid(), inputs.horizon_s, DT_S, inputs.rest, inputs.set)


def run(inputs: BenchmarkQuestion, context: Context) -> ProcessOutput:
    """Solve, compare, draw. A failed engine keeps its row, with its code and reason and without measures."""
    problem = problem_of(inputs)
    results = _solve(problem, inputs, context)
    inside = problem.inside()
    masks = {name: r.mask for name, r in results.items() if r.mask is not None}
    cell_area = problem.grid.cell_area(problem.scenario.corridor)
    certified = certified_in(masks)
    contained = None
    if certified is not None and certified.any():
        starts = problem.points()[certified]
        contained = containment_horizon(problem.scenario, starts, problem.rest, DT_S, start=problem.horizon)
    printed = TABLE2.get(inputs.omega_t_deg_s, {}) if inputs.a_max_m_s2 == TABLE2_THRUST_M_S2 else {}
    rows = [
        _row(name, result, masks, inside, cell_area, results) | {"published": printed.get(name)}
        for name, result in results.items()
    ]
    document = {
        "corridor_cells": int(np.count_nonzero(inside)),
        "cell_area_m2": cell_area,
        "containment_horizon_s": contained,
        "rows": rows,
        "notes": notes(inputs, rows, contained),
    }
    return ProcessOutput(document, _artifacts(problem, results))


def certified_in(masks: Mapping[str, Bools]) -> Bools | None:
    """What the certificate says: the sound one, or the paper's conditions where only they were run."""
    return masks.get("certified", masks.get("analytical"))


def _solve(problem: Problem, inputs: BenchmarkQuestion, context: Context) -> dict[str, EngineResult]:
    total = sum(engine_spec(name).share for name in inputs.engines) + _FINISH
    done = 0.0
    inside = problem.inside()
    results: dict[str, EngineResult] = {}
    for name in inputs.engines:
        share = engine_spec(name).share
        solver = engine(name, inputs.options(name))
        found = solver.solve(problem, context.part(done, share, total, name))
        results[name] = found.fit(name, inside)
        done += share
        context.step(done, total, f"{name} done")
    return results


def _row(
    name: str,
    result: EngineResult,
    masks: Mapping[str, Bools],
    inside: Bools,
    cell_area: float,
    results: Mapping[str, EngineResult],
) -> dict[str, Any]:
    mask, certified = result.mask, certified_in(masks)
    hj = results.get("hamilton_jacobi")
    row: dict[str, Any] = {
        "engine": name,
        "code": result.code.value,
        "message": result.message,
        "cells": None if mask is None else int(np.count_nonzero(mask)),
        "area_m2": None if mask is None else cell_area * int(np.count_nonzero(mask)),
        "confusion": None,
        "run_s": result.run_s,
        "compile_s": result.compile_s,
        "speedup_vs_hj": ratio(hj.run_s, result.run_s) if hj is not None and hj.mask is not None else None,
        "detail": dict(result.detail),
    }
    if mask is not None and certified is not None:
        row["confusion"] = ConfusionMatrix.of(certified, mask, inside).document()
    for short, reference in (("hj", "hamilton_jacobi"), ("exact", "exact")):
        row |= _against(short, mask, masks.get(reference))
    return row


def _against(short: str, mask: Bools | None, other: Bools | None) -> dict[str, float | None]:
    """Area ratio, IoU and violation fraction against one reference; None when either has no mask."""
    keys = (f"area_ratio_vs_{short}", f"iou_vs_{short}", f"violation_vs_{short}")
    if mask is None or other is None:
        return dict.fromkeys(keys)
    area = ratio(int(np.count_nonzero(mask)), int(np.count_nonzero(other)))
    return dict(zip(keys, (area, iou(mask, other), violation(mask, other)), strict=True))


def _artifacts(problem: Problem, results: Mapping[str, EngineResult]) -> tuple[Artifact | Undrawn, ...]:
    x, y = problem.grid.axes(problem.scenario.corridor)
    arrays: dict[str, Any] = {"x_m": x, "y_m": y, "inside": problem.inside()}
    for name, result in results.items():
        if result.mask is not None:
            arrays[f"{name}_mask"] = result.mask
        if result.margin is not None:
            arrays[f"{name}_margin_m"] = result.margin
        for key, value in result.arrays.items():
            arrays[f"{name}_{key}"] = value
    return overlay_map(problem, results), agreement_panels(problem, results), npz("maps.npz", arrays)

"""Run coverage: one certificate map per pair of tumble rate and thrust."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safestart.closed_form.by_name import map_of
from safestart.closed_form.paper import range_limit
from safestart.model.scenario import Bools, Chaser, Scenario, Target
from safestart.processes.base import ProcessOutput
from safestart.processes.coverage.plots import coverage_map
from safestart.processes.coverage.spec import CoverageInputs
from safestart.processes.plotting import npz
from safestart.processes.wire import finite
from safestart.runtime.progress import Context


def run(inputs: CoverageInputs, context: Context) -> ProcessOutput:
    """Certify every pair; artifacts are the picture and the masks ``[rate][thrust][iy][ix]``."""
    shape, grid = inputs.corridor.shape(), inputs.grid.grid()
    rates, thrusts = inputs.omega_t_deg_s, inputs.a_max_m_s2
    cells: list[dict[str, Any]] = []
    masks: Bools = np.zeros((len(rates), len(thrusts), grid.ny, grid.nx), dtype=np.bool_)
    for i, rate in enumerate(rates):
        for k, thrust in enumerate(thrusts):
            target = Target(math.radians(rate), inputs.mean_motion_rad_s)
            scenario = Scenario(target, Chaser(thrust), shape)
            region = map_of(inputs.certificate, scenario, grid)
            paper = region if inputs.certificate == "paper" else map_of("paper", scenario, grid)
            masks[i, k] = region.mask
            cells.append(
                {
                    "omega_t_deg_s": rate,
                    "a_max_m_s2": thrust,
                    "safe_percent": 100.0 * region.safe_fraction,
                    "paper_percent": 100.0 * paper.safe_fraction,
                    "r_sync_m": finite(range_limit(scenario)),
                }
            )
            context.step(len(cells), len(rates) * len(thrusts) + 1, f"{rate:g} deg/s, {thrust:g} m/s^2")
    x, y = grid.axes(shape)
    arrays = {
        "mask": masks,
        "x_m": x,
        "y_m": y,
        "omega_t_deg_s": np.array(rates),
        "a_max_m_s2": np.array(thrusts),
    }
    picture = coverage_map(inputs.certificate, shape, grid, rates, thrusts, masks)
    return ProcessOutput({"cells": cells}, (picture, npz("masks.npz", arrays)))

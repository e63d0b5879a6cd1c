"""The region of tracking-mpc: which starts the controller takes, from which it arrives, which any history can."""

from __future__ import annotations

from typing import Any

import numpy as np

from safestart.model.metrics import ConfusionMatrix
from safestart.model.scenario import Bools
from safestart.processes.base import Artifact
from safestart.processes.plotting import npz
from safestart.processes.tracking_mpc.setup import Setup
from safestart.processes.tracking_mpc.spec import TrackingMpcInputs
from safestart.tracking.any_history import AnyHistory
from safestart.tracking.region import by_any_history, by_flight, by_program, grid_of


def region(inputs: TrackingMpcInputs, setup: Setup, histories: AnyHistory) -> dict[str, Any]:
    """``Region``."""
    assert inputs.region is not None
    grid = grid_of(setup.shape, inputs.region.rows, inputs.region.z_m)
    taken = by_program(setup.program, setup.attitudes, grid)
    reached = by_any_history(histories, setup.attitudes[0], grid)
    arrives = by_flight(setup.program, setup.tumble, setup.attitudes, grid, inputs.steps, taken)
    both, either = int((taken & reached).sum()), int((taken | reached).sum())
    masks = {"tracking_mpc": taken, "arrives": arrives, "any_history": reached}
    matrix = ConfusionMatrix.of(taken, reached, np.ones(len(taken), dtype=bool)).document()
    return {
        "x_m": grid.points[:, 0].tolist(),
        "y_m": grid.points[:, 1].tolist(),
        "z_m": grid.points[:, 2].tolist(),
        "mpct": _mask(taken),
        "arrives": _mask(arrives),
        "exact": _mask(reached),
        "share": both / int(reached.sum()) if reached.any() else None,
        "iou": both / either if either else None,
        "confusion": {name: matrix[name] for name in ("tp", "fp", "fn", "tn")},
        "sets": [{"set": name, "cells": int(mask.sum())} for name, mask in masks.items()],
        "matrices": [
            {"claim": claim, **_matrix(masks[claim], reached)} for claim in ("tracking_mpc", "arrives")
        ],
    }


def _mask(mask: Bools) -> dict[str, Any]:
    return {"count": int(mask.sum()), "mask": mask.tolist()}


def _matrix(claimed: Bools, true: Bools) -> dict[str, Any]:
    return ConfusionMatrix.of(claimed, true, np.ones(len(claimed), dtype=bool)).document()


def maps(found: dict[str, Any]) -> Artifact:
    """``region.npz``: masks (ny, nx) of the first layer on x_m and y_m, for the page's comparison of sets."""
    points = np.array([found["x_m"], found["y_m"], found["z_m"]])
    first = points[2] == points[2, 0]
    x, y = np.unique(points[0, first]), np.unique(points[1, first])
    column, row = np.searchsorted(x, points[0, first]), np.searchsorted(y, points[1, first])
    arrays: dict[str, Any] = {"x_m": x, "y_m": y}
    whole = {"inside": np.ones(len(points[0]), dtype=bool)} | {
        f"{name}_mask": np.array(found[key]["mask"])
        for name, key in (("tracking_mpc", "mpct"), ("arrives", "arrives"), ("any_history", "exact"))
    }
    for name, mask in whole.items():
        arrays[name] = np.zeros((len(y), len(x)), dtype=bool)
        arrays[name][row, column] = mask[first]
    return npz("region.npz", arrays)

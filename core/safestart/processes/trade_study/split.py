"""Shards of a trade study, one per operating point, and what they say; light."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from safestart.constraints.corridor import corridor_of
from safestart.processes.trade_study.spec import TradeStudyInputs


def split(inputs: TradeStudyInputs) -> list[dict[str, Any]]:
    """Parts ``{"inputs", "omega", "a_max"}``."""
    dumped = inputs.model_dump(mode="json")
    return [
        {"inputs": dumped, "omega": omega, "a_max": a_max}
        for a_max in inputs.a_max_m_s2
        for omega in inputs.omega_t_deg_s
    ]


def summary(inputs: TradeStudyInputs, documents: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """The points so far."""
    shape, grid = inputs.corridor.shape(), inputs.grid.grid()
    inside = int(corridor_of(shape).contains(grid.points(shape)).sum())
    return {"corridor_points": inside, "corridor_area_m2": area(inputs), "points": list(documents)}


def area(inputs: TradeStudyInputs) -> float:
    """Area of the corridor cut at the grid's end, m^2: a trapezium."""
    shape = inputs.corridor.shape()
    height = inputs.grid.y_max_m - shape.hold_radius
    return height * (2.0 * shape.x0 + shape.c_x * height)

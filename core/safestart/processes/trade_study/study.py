"""The outcome of each operating point of a trade study, and the outputs; light to import."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from safestart.campaign.design import Factorial
from safestart.campaign.kept import Listed
from safestart.campaign.study import Study
from safestart.campaign.table import Column, Kind
from safestart.constraints.corridor import corridor_of
from safestart.processes.trade_study.spec import TradePoint, TradeStudyInputs


def study_of(inputs: TradeStudyInputs) -> Study:
    """One case per operating point, a shard each."""
    design = Factorial({"a_max_m_s2": inputs.a_max_m_s2, "omega_t_deg_s": inputs.omega_t_deg_s})
    names = tuple(TradePoint.model_fields)
    outcome = [Column(name, Kind.TEXT if name == "message" else Kind.NUMBER) for name in names]
    return Study(design, outcome, Listed(names))


def split(inputs: TradeStudyInputs) -> list[dict[str, Any]]:
    """The shards."""
    return study_of(inputs).parts(inputs.model_dump(mode="json"))


def summary(inputs: TradeStudyInputs, documents: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """The points so far."""
    shape, grid = inputs.corridor.shape(), inputs.grid.grid()
    inside = int(corridor_of(shape).contains(grid.points(shape)).sum())
    columns = study_of(inputs).total(documents).said
    names = tuple(TradePoint.model_fields)
    points = [
        dict(zip(names, row, strict=True)) for row in zip(*(columns[name] for name in names), strict=True)
    ]
    return {"corridor_points": inside, "corridor_area_m2": area(inputs), "points": points}


def area(inputs: TradeStudyInputs) -> float:
    """Area of the corridor cut at the grid's end, m^2: a trapezium."""
    shape = inputs.corridor.shape()
    height = inputs.grid.y_max_m - shape.hold_radius
    return height * (2.0 * shape.x0 + shape.c_x * height)

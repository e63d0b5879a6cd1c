"""The starts of a safe-abort map and their outcomes. Light to import: the service shows partial results."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from safestart.campaign.combined import Each
from safestart.campaign.design import Factorial, Parameters
from safestart.campaign.kept import Listed
from safestart.campaign.study import Study
from safestart.campaign.table import Column, Kind
from safestart.campaign.tally import Values
from safestart.processes.safe_abort_map.spec import SafeAbortMapInputs

LIMITS = ("safe_abort_until_min", "all_proved_until_min")


def design_of(inputs: SafeAbortMapInputs) -> Factorial:
    """One case per start: ring by ring from inside out, or row by row in y."""
    if inputs.starts == "grid":
        grid = inputs.grid
        rows = _linspace(grid.y_from_m, grid.y_to_m, grid.ny)
        return Factorial({"y_m": rows, "x_m": _linspace(grid.x_from_m, grid.x_to_m, grid.nx)})
    arc = inputs.arc
    rings = _linspace(arc.inner_m, arc.outer_m, arc.rings)
    return Factorial({"radius_m": rings, "angle_deg": _linspace(arc.from_deg, arc.to_deg, arc.angles)})


def place(parameters: Parameters) -> tuple[float, float]:
    """The start (x, y) of a case, m."""
    if "radius_m" in parameters:
        radius, angle = parameters["radius_m"], math.radians(parameters["angle_deg"])
        return radius * math.cos(angle), radius * math.sin(angle)
    return parameters["x_m"], parameters["y_m"]


def places(inputs: SafeAbortMapInputs) -> list[tuple[float, float]]:
    """Every start (x, y), m."""
    design = design_of(inputs)
    return [place(parameters) for parameters in design.parameters(0, len(design))]


def _linspace(first: float, last: float, count: int) -> list[float]:
    return [first + (last - first) * k / max(1, count - 1) for k in range(count)]


def study_of(inputs: SafeAbortMapInputs) -> Study:
    """Both limits of each start (unknown inside the guard), and the reason that ended its proof of powered flight."""
    outcome = [*(Column(name, Kind.NUMBER) for name in LIMITS), Column("reason", Kind.TEXT)]
    tally = Each({"starts": Listed(LIMITS), "reasons": Values("reason")})
    return Study(design_of(inputs), outcome, tally, inputs.starts_per_shard)


def split(inputs: SafeAbortMapInputs) -> list[dict[str, Any]]:
    """Shards of ``starts_per_shard`` starts."""
    return study_of(inputs).parts(inputs.model_dump(mode="json"))


def summary(inputs: SafeAbortMapInputs, documents: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """The result of the given shards; starts without an answer are null."""
    starts = places(inputs)
    total = study_of(inputs).total(documents)
    found = total.said["starts"]
    limits: dict[str, list[float | None]] = {name: [None] * len(starts) for name in LIMITS}
    for name, values in limits.items():
        for case, value in zip(found["case"], found[name], strict=True):
            values[case] = value
    return {
        "x_m": [x for x, _ in starts],
        "y_m": [y for _, y in starts],
        **limits,
        "reasons": total.said["reasons"],
        "shards_done": total.shards,
        "starts_done": len(found["case"]),
    }

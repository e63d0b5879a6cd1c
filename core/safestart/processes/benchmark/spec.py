"""benchmark: the certificate against every reachability engine (paper 000, Table 2)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, create_model, model_validator

from safestart.engines.registry import ENGINES
from safestart.model.scenario import Rest, SetKind
from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.views import Column, Comparison, Facts, Matrices, Overlay, Rows
from safestart.processes.wire import DISTINCT, Confusion, GridInput, Horizon, ScenarioInput, Seed
from safestart.runtime.named import misregistered

if TYPE_CHECKING:
    EngineName = str
else:
    EngineName = Literal[tuple(ENGINES)]


class BenchmarkQuestion(ScenarioInput):
    """One operating point and what to compare, without the options of the engines."""

    grid: GridInput = Field(default_factory=GridInput)
    engines: Annotated[list[EngineName], DISTINCT] = Field(
        [name for name, spec in ENGINES.items() if spec.default],
        min_length=1,
        max_length=len(ENGINES),
        description="Engines to run.",
    )
    horizon_s: Horizon = Field(40.0, description="Horizon of the reachable sets, s; a multiple of 2 s.")
    rest: Rest = Field(Rest.LVLH, description="Frame in which the starts are at rest.")
    set: SetKind = Field(
        SetKind.FIXED,
        description="fixed: in the corridor at the horizon; tube: at some time up to it (the whole corridor at t = 0).",
    )

    @model_validator(mode="after")
    def _affordable(self) -> BenchmarkQuestion:
        if self.grid.nx * self.grid.ny > 40_401:
            raise ValueError("grid: nx * ny at most 40401 (201 x 201) for a benchmark")
        if self.grid.y_max_m <= self.corridor.r_h_m:
            raise ValueError("grid.y_max_m: more than corridor.r_h_m")
        return self

    def options(self, engine: str) -> WireModel | None:
        """The options of an engine; None when it has none."""
        found: WireModel | None = getattr(self, engine) if engine in _OPTIONS else None
        return found


def _require_free(names: Iterable[str]) -> None:
    """Raise ``Misregistered`` for an engine whose name is a field of the inputs, or anything else of their class."""
    for name in names:
        if name == "seed" or name in BenchmarkQuestion.model_fields or hasattr(BenchmarkQuestion, name):
            raise misregistered("name of an engine", "no field of the benchmark's inputs", name)


_require_free(ENGINES)
_OPTIONS: dict[str, Any] = {
    spec.name: (spec.options, Field(default_factory=spec.options))
    for spec in ENGINES.values()
    if spec.options
}
BenchmarkInputs = create_model(
    "BenchmarkInputs",
    __base__=BenchmarkQuestion,
    __module__=__name__,
    __doc__="One operating point and what to compare.",
    **_OPTIONS,
    seed=(Seed, 0),
)
"""The question, with each engine's options, if it has any, under the engine's name."""


class PublishedRow(WireModel):
    """What Iskender et al. print for this engine in Table 2 (0.10 m/s^2; 1, 3 and 5 deg/s)."""

    iou_vs_hj: float
    area_ratio: float
    run_s: float


class EngineRow(WireModel):
    """What one engine found; measures that its code or an absent reference forbids are null."""

    engine: EngineName
    code: str
    message: str
    cells: int | None = Field(description="Cells of the grid in the engine's set.")
    area_m2: float | None
    area_ratio_vs_hj: float | None
    area_ratio_vs_exact: float | None
    iou_vs_hj: float | None
    iou_vs_exact: float | None
    violation_vs_hj: float | None = Field(description="|A minus HJ| / |A|.")
    violation_vs_exact: float | None = Field(description="|A minus exact| / |A|.")
    confusion: Confusion | None = Field(
        description="The certificate against this engine (actual: in its set), over the corridor's cells; engine "
        "certified, or analytical where only that was run."
    )
    run_s: float
    compile_s: float
    speedup_vs_hj: float | None
    published: PublishedRow | None = Field(
        None, description="Table 2 of the paper, where it has this operating point."
    )
    detail: dict[str, Any]


class BenchmarkOutputs(WireModel):
    """Rows in the order of the engines asked for; masks and values are in the NPZ artifact."""

    corridor_cells: int
    cell_area_m2: float
    containment_horizon_s: float | None = Field(
        description="Smallest horizon, from horizon_s on, at which the exact fixed-time set holds every certified "
        "start; null: none up to 600 s, or nothing is certified."
    )
    rows: list[EngineRow]
    notes: list[str]


_ENGINE_COLUMNS = (
    Column("engine", "engine"),
    Column("code", "code"),
    Column("cells", "cells"),
    Column("area [m²]", "area_m2"),
    Column("IoU with exact", "iou_vs_exact"),
    Column("IoU with HJ", "iou_vs_hj"),
    Column("area / HJ", "area_ratio_vs_hj"),
    Column("outside exact", "violation_vs_exact"),
    Column("run [s]", "run_s"),
    Column("compile [s]", "compile_s"),
    Column("faster than HJ", "speedup_vs_hj"),
    Column("paper: IoU with HJ", "published.iou_vs_hj"),
    Column("paper: area / HJ", "published.area_ratio"),
    Column("paper: run [s]", "published.run_s"),
)

SPEC = ProcessSpec(
    id="benchmark",
    title="Certificate against the reachability engines",
    description=(
        "Runs the chosen engines on one operating point and grid and compares their safe-start regions: areas, IoU, "
        "violation fractions, confusion matrices, times. The certificate in closed form is answered at submission; the "
        "paper's conditions (analytical, not sound) run beside it."
    ),
    inputs=BenchmarkInputs,
    outputs=BenchmarkOutputs,
    kernels=("flights", "level sets", "reachable sets"),
    run="safestart.processes.benchmark.run:run",
    instant="safestart.processes.certificate.run:answer",
    keywords=("reachability", "Hamilton-Jacobi", "Monte Carlo", "IoU"),
    views=(
        Facts(
            (
                Column("Corridor cells", "corridor_cells"),
                Column("Area of a cell [m²]", "cell_area_m2"),
                Column("Certified region contained from [s]", "containment_horizon_s"),
            )
        ),
        Rows("Engines", "rows", _ENGINE_COLUMNS),
        Matrices(
            "The certificate against each engine",
            "Rows: the certificate's word. Columns: in the engine's set or not. Membership in a set is no verdict: an "
            "outer set also holds starts from which no thrust arrives. Intervals: Wilson, 95 %.",
            path="rows.*.confusion",
            names=("engine",),
            heading="{0}",
            claims=("certified", "not certified"),
            facts=("in the set", "not in it"),
            cells=(
                "certified, in the set",
                "certified, not in it",
                "in the set, not certified",
                "in neither",
            ),
            omit=("certified", "analytical"),
        ),
        Overlay("Agreement on the map", "maps.npz", table="rows", by="engine", certain="certified"),
        Comparison(
            table="rows",
            by="engine",
            measures=(
                Column("area [m²]", "area_m2"),
                Column("IoU with exact", "iou_vs_exact"),
                Column("IoU with Hamilton-Jacobi", "iou_vs_hj"),
                Column("share outside exact", "violation_vs_exact"),
                Column("run [s]", "run_s"),
            ),
            logarithmic=("run_s",),
        ),
    ),
    extensions={"safestart:engines": [spec.document() for spec in ENGINES.values()]},
    example={
        "omega_t_deg_s": 3,
        "a_max_m_s2": 0.1,
        "grid": {"nx": 31, "ny": 31, "y_max_m": 150},
        "horizon_s": 40,
    },
)

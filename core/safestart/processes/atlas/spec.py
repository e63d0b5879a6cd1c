"""atlas: the starts at rest that can stay in the corridor, between proved polygons."""

from __future__ import annotations

from pydantic import Field

from safestart.processes.base import ProcessSpec, Table, WireModel
from safestart.processes.views import Column, Facts
from safestart.processes.wire import GridInput, Pair, ScenarioInput, Triple


class AtlasInputs(ScenarioInput):
    """One operating point, how long to stay, and how narrow the strip between the polygons must be."""

    grid: GridInput = Field(default_factory=GridInput)
    horizon_s: float = Field(60.0, gt=0, le=600, description="How long to stay in the corridor, s.")
    dt_s: float = Field(2.0, ge=0.1, le=60, description="Interval over which thrust is held, s.")
    gap: float = Field(
        0.005, ge=1e-4, le=1, description="Largest share of the outer area that stays undecided."
    )


class AtlasOutputs(WireModel):
    """Proved GO polygon, proved NO_GO half-planes, and the grid's cells; masks row-major ``[iy][ix]``."""

    inner_area_m2: float
    outer_area_m2: float
    relative_gap: float = Field(description="(outer - inner) / outer area.")
    deepest_start_m: list[float] = Field(description="Start with the largest margin, body-frame x, y.")
    deepest_margin_m: float
    inner_polygon_m: list[Pair] = Field(description="Corners of the polygon of proved GO, counter-clockwise.")
    half_planes: list[Triple] = Field(
        description="Rows (a, b, c): a x + b y + c bounds the margin of every start, m; negative proves NO_GO."
    )
    verdict_cells: dict[str, int] = Field(description="Cells of the corridor by verdict.")
    certified_outside: int = Field(
        description="Cells that the paper's conditions, which are not sound, certify and the atlas proves NO_GO."
    )
    message: str


SPEC = ProcessSpec(
    id="atlas",
    title="Proof atlas of the starts that can stay",
    description=(
        "Exact answer for every start at rest in LVLH: can any thrust history keep it in the rotating corridor at all "
        "times of the horizon? Inner polygon of proved GO, outer half-planes of proved NO_GO, a thin strip undecided; "
        "witnesses and multipliers are in the artifact proofs.npz, from which go-no-go then answers (method auto)."
    ),
    inputs=AtlasInputs,
    outputs=AtlasOutputs,
    kernels=("exact answers",),
    run="safestart.processes.atlas.run:run",
    tables=(Table("inner_polygon_m", ("inner_polygon_m",)), Table("half_planes", ("half_planes",))),
    views=(
        Facts(
            (
                Column("Area proved GO [m²]", "inner_area_m2"),
                Column("Area outside of which NO_GO is proved [m²]", "outer_area_m2"),
                Column("Share left undecided", "relative_gap"),
                Column("Cells proved GO", "verdict_cells.GO"),
                Column("Cells proved NO_GO", "verdict_cells.NO_GO"),
                Column("Cells undecided", "verdict_cells.UNDECIDED"),
                Column(
                    "Cells of the paper's conditions (not sound) that are proved NO_GO", "certified_outside"
                ),
                Column("Largest margin [m]", "deepest_margin_m"),
                Column("at x [m]", "deepest_start_m.0"),
                Column("at y [m]", "deepest_start_m.1"),
                Column("Why the polygons are farther apart than usual", "message"),
            )
        ),
    ),
    keywords=("exact", "proof", "safe-start region"),
    example={"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "grid": {"nx": 31, "ny": 31, "y_max_m": 150}},
)

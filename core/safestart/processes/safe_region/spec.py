"""safe-region: where may a chaser at rest start? The exact region between two proved polygons, at once."""

from __future__ import annotations

from pydantic import Field

from safestart.processes.base import ProcessSpec, Table, WireModel
from safestart.processes.costs import region_s
from safestart.processes.views import Column, Facts, Layer, Picture
from safestart.processes.wire import Horizon, Pair, ScenarioInput


class SafeRegionInputs(ScenarioInput):
    """One operating point, how long to stay, and where the picture ends."""

    horizon_s: Horizon = Field(60.0, description="How long to stay in the corridor, s.")
    y_max_m: float = Field(150.0, gt=0, le=5000, description="Where the corridor is cut, m.")


class SafeRegionOutputs(WireModel):
    """Corners (x, y) in the body frame, m, counter-clockwise; empty where nothing is left."""

    inner_polygon_m: list[Pair] = Field(description="Every start inside is proved GO.")
    outer_polygon_m: list[Pair] = Field(description="Every start of the corridor outside is proved NO_GO.")
    inner_area_m2: float
    outer_area_m2: float
    deepest_start_m: list[float] = Field(description="Start with the largest margin.")
    deepest_margin_m: float
    message: str = Field(description="Why the polygons are farther apart than usual; else empty.")


SPEC = ProcessSpec(
    id="safe-region",
    title="Exact safe-start region",
    description=(
        "Outline of the starts at rest in LVLH from which some thrust history stays in the rotating corridor at all "
        "times: inside the inner polygon proved GO, outside the outer one proved NO_GO. The first answer of an "
        "operating point takes some tenths of a second, later ones come from the cache. Process atlas gives the proofs."
    ),
    inputs=SafeRegionInputs,
    outputs=SafeRegionOutputs,
    kernels=("exact answers",),
    run="safestart.processes.safe_region.run:run",
    light=True,
    cost=lambda inputs: region_s(inputs.horizon_s),
    tables=(Table("inner_polygon_m", ("inner_polygon_m",)), Table("outer_polygon_m", ("outer_polygon_m",))),
    views=(
        Facts(
            (
                Column("Area proved GO [m²]", "inner_area_m2"),
                Column("Area outside of which NO_GO is proved [m²]", "outer_area_m2"),
                Column("Largest margin [m]", "deepest_margin_m"),
                Column("at x [m]", "deepest_start_m.0"),
                Column("at y [m]", "deepest_start_m.1"),
                Column("Why the polygons are farther apart than usual", "message"),
            )
        ),
        Picture(
            "Starts that can stay",
            "x [m], target's body frame",
            "y [m], target's body frame",
            (
                Layer(
                    "proved GO",
                    "area",
                    "inner_polygon_m",
                    "inner_polygon_m.0",
                    "inner_polygon_m.1",
                    colour="exact",
                ),
                Layer(
                    "outside: proved NO_GO",
                    "area",
                    "outer_polygon_m",
                    "outer_polygon_m.0",
                    "outer_polygon_m.1",
                    colour="lost",
                ),
            ),
            equal=True,
        ),
    ),
    keywords=("exact", "safe-start region"),
    example={"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "horizon_s": 60, "y_max_m": 150},
)

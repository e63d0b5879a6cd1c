"""safe-abort-map: per start, the time up to which every abort is proved safe (paper 003, Fig. 5)."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from safestart.processes.base import ProcessSpec, Table, WireModel
from safestart.processes.passive_safety.rendezvous import RendezvousInputs, TargetBox
from safestart.processes.sharding import Sharding
from safestart.processes.views import Column, Facts, Rows

MAX_STARTS = 20_000


class ArcInput(WireModel):
    """Starts on an arc around the target: angle from +x (radial) to +y (along-track), rings from inside out."""

    from_deg: float = Field(180.0, ge=-360, le=360, description="First angle, deg.")
    to_deg: float = Field(270.0, ge=-360, le=720, description="Last angle, deg.")
    inner_m: float = Field(900.0, gt=100, le=2000, description="Radius of the first ring, m.")
    outer_m: float = Field(1050.0, gt=100, le=2000, description="Radius of the last ring, m.")
    rings: int = Field(4, ge=1, le=200)
    angles: int = Field(250, ge=1, le=2000)


class SquareInput(WireModel):
    """Starts on a grid; starts that are not wholly outside the guard are left out of the map."""

    x_from_m: float = Field(-1000.0, ge=-2000, le=2000)
    x_to_m: float = Field(1000.0, ge=-2000, le=2000)
    y_from_m: float = Field(-1000.0, ge=-2000, le=2000)
    y_to_m: float = Field(1000.0, ge=-2000, le=2000)
    nx: int = Field(32, ge=2, le=400)
    ny: int = Field(32, ge=2, le=400)


class SafeAbortMapInputs(RendezvousInputs):
    """Starts (at rest in the target's frame, each with its own small box), abort windows, the target's box."""

    starts: Literal["arc", "grid"] = Field("arc", description="Which of arc and grid holds the starts.")
    arc: ArcInput = Field(default_factory=lambda: ArcInput.model_validate({}))
    grid: SquareInput = Field(default_factory=lambda: SquareInput.model_validate({}))
    half_width_m: float = Field(
        5.0,
        ge=0,
        le=100,
        description="Half-width of each start's box in x and y, m: what is proved for all of it.",
    )
    last_abort_min: float = Field(240.0, gt=0, le=600, description="End of the last window, min.")
    windows: int = Field(48, ge=1, le=600, description="Equal windows between 0 and the last abort.")
    drift_min: float = Field(60.0, ge=0, le=120, description="How long drifts are followed after that, min.")
    box_half_width_m: TargetBox = 0.1
    starts_per_shard: int = Field(20, ge=1, le=1000)

    @model_validator(mode="after")
    def _starts(self) -> SafeAbortMapInputs:
        arc, grid = self.arc, self.grid
        if arc.to_deg < arc.from_deg or arc.to_deg - arc.from_deg > 360:
            raise ValueError("arc: from_deg <= to_deg <= from_deg + 360")
        if arc.outer_m < arc.inner_m:
            raise ValueError("arc: inner_m <= outer_m")
        if grid.x_to_m <= grid.x_from_m or grid.y_to_m <= grid.y_from_m:
            raise ValueError("grid: x_from_m < x_to_m and y_from_m < y_to_m")
        count = arc.rings * arc.angles if self.starts == "arc" else grid.nx * grid.ny
        if count > MAX_STARTS:
            raise ValueError(f"starts: at most {MAX_STARTS}, received {count}")
        return self


class SafeAbortMapOutputs(WireModel):
    """Per start, ring by ring or row by row; null when the start is not wholly outside the guard."""

    x_m: list[float]
    y_m: list[float]
    safe_abort_until_min: list[float | None] = Field(
        description="Every abort until then is proved apart from the box; 0: not even in the first window."
    )
    all_proved_until_min: list[float | None] = Field(
        description="The same, with thrust, line of sight and speed octagon proved until then."
    )
    reasons: dict[str, int] = Field(
        description="What ended the proof of the powered flight: starts per reason."
    )
    shards_done: int
    starts_done: int


SPEC = ProcessSpec(
    id="safe-abort-map",
    title="Safe-abort map of the switched rendezvous",
    description=(
        "Fig. 5 of Chan and Mitra, proved: for every start of an arc or a grid the time up to which each abort drifts "
        "past the target, and up to which thrust, line of sight and speed are proved as well. In parts."
    ),
    inputs=SafeAbortMapInputs,
    outputs=SafeAbortMapOutputs,
    kernels=("passive safety",),
    sharding=Sharding.of("safestart.processes.safe_abort_map"),
    tables=(Table("starts", ("x_m", "y_m", "safe_abort_until_min", "all_proved_until_min")),),
    views=(
        Facts((Column("Starts", "starts_done"), Column("Parts", "shards_done"))),
        Rows(
            "Starts",
            "starts",
            (
                Column("x [m]", "x_m"),
                Column("y [m]", "y_m"),
                Column("every abort proved apart until [min]", "safe_abort_until_min"),
                Column("and every requirement until [min]", "all_proved_until_min"),
            ),
        ),
    ),
    keywords=("verification", "passive safety", "abort", "map"),
    example={"starts": "arc", "arc": {"rings": 2, "angles": 60}, "box_half_width_m": 0.1},
)

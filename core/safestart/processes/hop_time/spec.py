"""hop-time: how long a hop along a line through the target takes, and up to which angle there is one."""

from __future__ import annotations

from pydantic import Field

from safestart.processes.base import ProcessSpec, Table, WireModel
from safestart.processes.views import Column, Facts, Layer, Picture
from safestart.processes.wire import Pair


class HopTimeInputs(WireModel):
    """One hop."""

    angle_deg: float = Field(
        ge=0,
        le=360,
        description="Angle of the line from the V-bar (ahead of the target) towards nadir, deg; 90: R-bar from below.",
        examples=[40.0],
    )
    rho: float = Field(
        ge=0,
        le=1.0 - 1e-6,
        description="Share of the distance to the target that the hop leaves.",
        examples=[0.7],
    )


class HopTimeOutputs(WireModel):
    """Its length, and where its branch ends."""

    orbits: float = Field(description="Length of the hop, in periods of the target's orbit.")
    fold_deg: float | None = Field(
        description="Angle, modulo 180 deg, beyond which there is no such hop; null: every angle has one."
    )
    path: list[Pair] = Field(
        description="The hop's path in LVLH: radial and along-track, in shares of the distance at its start."
    )


SPEC = ProcessSpec(
    id="hop-time",
    title="How long a hop takes",
    description=(
        "Length of a hop of Silva et al. along any line through the target that leaves a share rho of the distance and "
        "ends perpendicular to the line, in periods of a circular orbit, from the hop-time equation in closed form. "
        "Angles beyond the fold of its branch are refused."
    ),
    inputs=HopTimeInputs,
    outputs=HopTimeOutputs,
    run="safestart.processes.hop_time.run:run",
    light=True,
    tables=(Table("path", ("path",)),),
    views=(
        Facts((Column("Length [orbits]", "orbits"), Column("Fold [deg]", "fold_deg"))),
        Picture(
            "Path of the hop, the target at 0",
            "along-track [distance at the start]",
            "radial [distance at the start]",
            (Layer("hop", "line", "path", "path.1", "path.0"),),
            equal=True,
        ),
    ),
    keywords=("hopping", "guidance", "V-bar", "R-bar", "glideslope"),
    example={"angle_deg": 40, "rho": 0.7},
)

"""elliptic-start: the sound closed-form certificate on elliptic orbits, and the eccentricity up to which it holds."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from safestart.model.scenario import MAX_RANGE, Rest
from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.start_in_space.parts import EllipticOrbit
from safestart.processes.views import Column, Facts, Findings, Layer, Picture
from safestart.processes.wire import CorridorInput, Thrust

Coordinate = Annotated[float, Field(ge=-MAX_RANGE, le=MAX_RANGE)]
Place = Annotated[list[Coordinate], Field(min_length=3, max_length=3)]


class EllipticStartInputs(WireModel):
    """A target that spins steadily in inertial space about its orbit's normal, the orbit, the starts."""

    spin_deg_s: float = Field(
        gt=0, le=60, description="Spin in inertial space about LVLH z, deg/s.", examples=[3.0]
    )
    a_max_m_s2: Thrust
    orbit: EllipticOrbit
    corridor: CorridorInput = Field(default_factory=CorridorInput)
    rest: Rest = Field(Rest.LVLH, description="Frame in which the starts are at rest.")
    points_m: list[Place] = Field(
        min_length=1,
        max_length=100,
        description="Starts, body axes, which agree with LVLH's at the start, m.",
    )


class EllipticAnswer(WireModel):
    """One start."""

    x_m: float
    y_m: float
    z_m: float
    verdict: Literal["GO", "UNDECIDED"] = Field(
        description="GO: a manoeuvre keeps it in the corridor for ever."
    )
    margin_m: float = Field(description="GO: at least this far from every face at all times.")
    binding: str
    certified_up_to_eccentricity: float | None = Field(
        description="Certified on every orbit of this semi-major axis and anomaly up to here, at most 0.95; null: not "
        "even on the circular one."
    )


class EllipticStartOutputs(WireModel):
    """Answers in the order of the starts."""

    decided_by: Literal["certified"]
    starts: list[EllipticAnswer]
    lvlh_rate_deg_s: float = Field(description="Rate of LVLH at the start.")
    ground_eccentricity: float = Field(
        description="Where the perigee of this semi-major axis meets the ground."
    )


SPEC = ProcessSpec(
    id="elliptic-start",
    title="Certified start on an elliptic orbit",
    description=(
        "The closed-form certificate for a target that spins steadily in inertial space on any Kepler orbit: GO means "
        "that an explicit manoeuvre keeps the start in the corridor for ever within its thrust. And the eccentricity "
        "up to which each start stays certified."
    ),
    inputs=EllipticStartInputs,
    outputs=EllipticStartOutputs,
    run="safestart.processes.elliptic_start.run:run",
    light=True,
    views=(
        Findings(
            "Starts",
            "starts",
            word="verdict",
            columns=(
                Column("x [m]", "x_m"),
                Column("y [m]", "y_m"),
                Column("z [m]", "z_m"),
                Column("margin [m]", "margin_m"),
                Column("binding", "binding"),
                Column("certified up to eccentricity", "certified_up_to_eccentricity"),
            ),
        ),
        Facts(
            (
                Column("Rate of LVLH at the start [deg/s]", "lvlh_rate_deg_s"),
                Column("Perigee on the ground at eccentricity", "ground_eccentricity"),
            )
        ),
        Picture(
            "Starts",
            "x [m], target's body frame",
            "y [m], target's body frame",
            (Layer("start", "points", "starts", "x_m", "y_m", value="verdict"),),
            equal=True,
        ),
    ),
    keywords=("elliptic orbit", "certificate", "eccentricity"),
    example={
        "spin_deg_s": 3,
        "a_max_m_s2": 0.1,
        "orbit": {"semi_major_axis_m": 24_400_000, "eccentricity": 0.7},
        "points_m": [[0, 30, 0], [5, 60, 0]],
    },
)

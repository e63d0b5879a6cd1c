"""hop-angles: along which lines a hopping approach takes a given time, or costs a given amount of fuel."""

from __future__ import annotations

from pydantic import Field, model_validator

from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.hopping.wire import HopsInput
from safestart.processes.passive_abort.wire import SemiMajorAxis
from safestart.processes.views import Column, Facts, Layer, Picture, Rows

WANTED = ("orbits", "fuel_1norm_m_s", "fuel_2norm_m_s")


class HopAnglesInputs(HopsInput):
    """The target's orbit, the hops, and exactly one of time and fuel."""

    orbits: float | None = Field(
        None, gt=0, le=1e3, description="Wanted length of the approach, orbits.", examples=[0.7]
    )
    fuel_1norm_m_s: float | None = Field(
        None, gt=0, le=1e4, description="Or its wanted fuel, sum of |impulse|_1 in LVLH axes, m/s."
    )
    fuel_2norm_m_s: float | None = Field(
        None, gt=0, le=1e4, description="Or its wanted fuel, sum of the impulses' lengths, m/s."
    )
    semi_major_axis_m: SemiMajorAxis = 8.1e6

    @model_validator(mode="after")
    def _one_is_wanted(self) -> HopAnglesInputs:
        given = [name for name in WANTED if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(f"exactly one of {', '.join(WANTED)}; received {', '.join(given) or 'none'}")
        return self


class AngleOutput(WireModel):
    """One line, and the approach along it."""

    angle_deg: float = Field(description="0: V-bar ahead of the target, 90: R-bar below it.")
    orbits: float
    fuel_1norm_m_s: float
    fuel_2norm_m_s: float


class CurveOutput(WireModel):
    """A point of the curve of what is wanted over the angle."""

    angle_deg: float
    value: float


class HopAnglesOutputs(WireModel):
    """Every such line, what lines offer at all, and the curve."""

    wanted: str = Field(description="Name of what is wanted.")
    angles: list[AngleOutput] = Field(
        description="Ascending, from 0 deg to greatest_angle_deg; empty: none has it."
    )
    greatest_angle_deg: float = Field(description="Up to here every hop exists: the first fold.")
    least: float = Field(description="Least value of what is wanted, over the sampled angles.")
    greatest: float = Field(description="Greatest value.")
    curve: list[CurveOutput]


SPEC = ProcessSpec(
    id="hop-angles",
    title="Lines of approach for a given time or fuel",
    description=(
        "Every angle, from the V-bar ahead of the target to the fold of the hops, at which a hopping approach takes "
        "the wanted time or costs the wanted fuel. There may be none, one or several: over the angle time falls and "
        "rises again, and fuel rises and falls."
    ),
    inputs=HopAnglesInputs,
    outputs=HopAnglesOutputs,
    run="safestart.processes.hop_angles.run:run",
    light=True,
    cost=lambda inputs: 0.02 * inputs.hops,
    views=(
        Rows(
            "Lines of approach",
            "angles",
            (
                Column("angle [deg]", "angle_deg"),
                Column("length [orbits]", "orbits"),
                Column("fuel, 1-norm [m/s]", "fuel_1norm_m_s"),
                Column("2-norm [m/s]", "fuel_2norm_m_s"),
            ),
        ),
        Facts(
            (
                Column("Wanted", "wanted"),
                Column("Least over all angles", "least"),
                Column("Greatest", "greatest"),
                Column("Hops exist up to [deg]", "greatest_angle_deg"),
            )
        ),
        Picture(
            "What is wanted, over the angle",
            "angle [deg]",
            "{wanted}",
            (Layer("every angle", "line", "curve", "angle_deg", "value", colour="exact"),),
        ),
    ),
    keywords=("hopping", "guidance", "V-bar", "R-bar", "glideslope"),
    example={"orbits": 0.7},
)

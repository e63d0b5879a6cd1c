"""Keep-outs, field of view and plume rule as they appear on the wire, and as the demands of a question."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated

from pydantic import Field, Tag

from safestart.errors import InvalidInput, invalid
from safestart.exact.space.demands.rules import Demands, FieldOfView, KeepOut, Plume
from safestart.processes.base import WireModel
from safestart.processes.start_in_space.parts import Frame, Vector, has

Length = Annotated[float, Field(ge=0.001, le=10_000)]


class _KeepOut(WireModel):
    name: str = Field(min_length=1, max_length=40, description="Name, each once.")
    centre_m: Vector = Field(default_factory=lambda: [0.0, 0.0, 0.0], description="Centre, m.")
    frame: Frame = Field("body", description="Axes in which the region is fixed.")


class SphereKeepOut(_KeepOut):
    """The chaser stays out of a sphere."""

    radius_m: Length = Field(description="Radius, m.")


class BoxKeepOut(_KeepOut):
    """The chaser stays out of a box along the axes of its frame."""

    half_widths_m: list[Length] = Field(min_length=3, max_length=3, description="Half-widths, m.")


KeepOutInput = Annotated[
    Annotated[SphereKeepOut, Tag("sphere")] | Annotated[BoxKeepOut, Tag("box")],
    has("radius_m", "sphere", "box"),
]


class FieldOfViewInput(WireModel):
    """The target stays within a cone about a camera's axis; the camera's axis does not turn in ``frame``."""

    axis: Vector = Field(description="Where the camera looks from the chaser; its length does not matter.")
    half_angle_deg: float = Field(ge=1, le=85, description="Half-angle of the cone, deg.")
    point_m: Vector = Field(
        default_factory=lambda: [0.0, 0.0, 0.0], description="What must be seen, in the frame of the axis, m."
    )
    frame: Frame = Field("lvlh", description="Axes in which axis and point are fixed.")


class PlumeInput(WireModel):
    """Near the target no exhaust towards it."""

    half_angle_deg: float = Field(
        ge=1,
        le=80,
        description="No exhaust (opposite to the thrust) within this angle of the line of sight to the point, deg.",
    )
    range_m: Length = Field(description="Only this near to the point, m.")
    point_m: Vector = Field(default_factory=lambda: [0.0, 0.0, 0.0], description="The point, m.")
    frame: Frame = Field("body", description="Axes in which the point is fixed.")


_WIRE = {
    "centre": "centre_m",
    "size": "radius_m, half_widths_m",
    "half_angle": "half_angle_deg",
    "reach": "range_m",
    "point": "point_m",
}


def demands_of(
    keep_outs: Sequence[SphereKeepOut | BoxKeepOut], view: FieldOfViewInput | None, plume: PlumeInput | None
) -> Demands:
    """In SI units; raises ``InvalidInput`` under the wire names."""
    part = ""
    try:
        made = []
        for k, one in enumerate(keep_outs):
            part = f"keep_outs.{k}."
            size = (one.radius_m,) if isinstance(one, SphereKeepOut) else tuple(one.half_widths_m)
            made.append(KeepOut(one.name, _three(one.centre_m), size, one.frame))
        part = "field_of_view."
        seen = (
            None
            if view is None
            else FieldOfView(
                _three(view.axis), math.radians(view.half_angle_deg), _three(view.point_m), view.frame
            )
        )
        part = "plume."
        rule = (
            None
            if plume is None
            else Plume(math.radians(plume.half_angle_deg), plume.range_m, _three(plume.point_m), plume.frame)
        )
    except InvalidInput as error:
        field = str(error.field)
        raise invalid(f"{part}{_WIRE.get(field, field)}", str(error.required), error.received) from None
    return Demands(tuple(made), seen, rule)


def _three(values: Sequence[float]) -> tuple[float, float, float]:
    x, y, z = (float(e) for e in values)
    return x, y, z

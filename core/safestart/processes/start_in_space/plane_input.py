"""Planes of starts as they appear on the wire: any plane of positions, or of a position and a velocity."""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from safestart.exact.space.plane import LEAST_SPAN, MOST_SPAN
from safestart.model.scenario import Rest
from safestart.processes.base import WireModel
from safestart.processes.start_in_space.parts import Frame, Position, Vector, Velocity

Kind = Literal["position", "velocity"]
Coordinate = Annotated[float, Field(ge=-100_000, le=100_000)]
LEAST_LENGTH, _LEAST_ANGLE = 1e-9, 1e-5


class PlaneAxis(WireModel):
    """One coordinate of a plane."""

    kind: Kind = Field("position", description="What the coordinate moves: position (m) or velocity (m/s).")
    direction: Vector = Field(description="Along which direction; its length does not matter.")
    low: Coordinate = Field(description="Least value, m or m/s.")
    high: Coordinate = Field(description="Largest value; above low by 0.001 at least.")

    @model_validator(mode="after")
    def _has_length(self) -> PlaneAxis:
        if math.hypot(*self.direction) < LEAST_LENGTH:
            raise ValueError("direction: required three numbers, not all 0")
        if not LEAST_SPAN <= self.high - self.low <= MOST_SPAN:
            raise ValueError(f"low: required less than high by {LEAST_SPAN:g} to {MOST_SPAN:g}")
        return self


class PlaneInput(WireModel):
    """Starts origin + a first + b second, everything else fixed."""

    name: str = Field(min_length=1, max_length=40, description="Name, each once.")
    origin_m: Position = Field(
        default_factory=lambda: [0.0, 0.0, 0.0], description="Position at a = b = 0, m."
    )
    velocity_m_s: Velocity = Field(
        default_factory=lambda: [0.0, 0.0, 0.0],
        description="Velocity at a = b = 0, in the axes of frame, m/s.",
    )
    frame: Frame = Field("body", description="Axes of all vectors, at t = 0.")
    rest: Rest = Field(Rest.LVLH, description="What velocities are against: LVLH, or the turning body.")
    first: PlaneAxis = Field(description="Coordinate a, drawn across.")
    second: PlaneAxis = Field(description="Coordinate b, drawn upwards.")

    @model_validator(mode="after")
    def _is_a_plane(self) -> PlaneInput:
        a, b = (np.array(axis.direction) / math.hypot(*axis.direction) for axis in (self.first, self.second))
        if self.first.kind == self.second.kind and math.hypot(*np.cross(a, b).tolist()) < _LEAST_ANGLE:
            raise ValueError("second.direction: required another direction than first")
        return self

    def labels(self) -> tuple[str, str]:
        """Names of the two axes, with their units."""
        first, second = (
            f"{axis.kind} along {_short(axis.direction)}, {self.frame} [{'m' if axis.kind == 'position' else 'm/s'}]"
            for axis in (self.first, self.second)
        )
        return first, second


_AXES = {"x": [1.0, 0.0, 0.0], "y": [0.0, 1.0, 0.0], "z": [0.0, 0.0, 1.0]}


def coordinate_planes(centre: list[float], size: float, rest: Rest = Rest.LVLH) -> list[PlaneInput]:
    """The three planes of the body frame through ``centre`` (m), ``size`` m to every side, in body coordinates."""
    at = dict(zip(_AXES, centre, strict=True))
    return [
        PlaneInput(
            name=a + b,
            origin_m=[0.0 if name in (a, b) else value for name, value in at.items()],
            rest=rest,
            first=PlaneAxis(direction=_AXES[a], low=at[a] - size, high=at[a] + size),
            second=PlaneAxis(direction=_AXES[b], low=at[b] - size, high=at[b] + size),
        )
        for a, b in (("x", "y"), ("z", "y"), ("x", "z"))
    ]


def _short(direction: list[float]) -> str:
    for name, axis in _AXES.items():
        if direction == axis:
            return name
    return f"({', '.join(f'{e:g}' for e in direction)})"

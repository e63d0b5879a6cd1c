"""Planes of starts as they appear on the wire: any plane of positions, or of a position and a velocity."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from safestart.errors import InvalidInput, invalid
from safestart.exact.space.plane import Plane
from safestart.exact.space.question import SpaceQuestion, starts_in_lvlh
from safestart.model.scenario import Floats, Rest
from safestart.processes.base import WireModel
from safestart.processes.start_in_space.parts import Frame, Number, Vector

Kind = Literal["position", "velocity"]


class PlaneAxis(WireModel):
    """One coordinate of a plane."""

    kind: Kind = Field("position", description="What the coordinate moves: position (m) or velocity (m/s).")
    direction: Vector = Field(description="Along which direction; its length does not matter.")
    low: Number = Field(description="Least value, m or m/s.")
    high: Number = Field(description="Largest value.")


class PlaneInput(WireModel):
    """Starts origin + a first + b second, everything else fixed."""

    name: str = Field(min_length=1, max_length=40, description="Name, each once.")
    origin_m: Vector = Field(default_factory=lambda: [0.0, 0.0, 0.0], description="Position at a = b = 0, m.")
    velocity_m_s: Vector = Field(
        default_factory=lambda: [0.0, 0.0, 0.0],
        description="Velocity at a = b = 0, in the axes of frame, m/s.",
    )
    frame: Frame = Field("body", description="Axes of all vectors, at t = 0.")
    rest: Rest = Field(Rest.LVLH, description="What velocities are against: LVLH, or the turning body.")
    first: PlaneAxis = Field(description="Coordinate a, drawn across.")
    second: PlaneAxis = Field(description="Coordinate b, drawn upwards.")

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


def plane_of(said: PlaneInput, question: SpaceQuestion, field: str) -> Plane:
    """In LVLH and SI units; raises ``InvalidInput`` under the wire names below ``field``."""
    columns = []
    for name, axis in (("first", said.first), ("second", said.second)):
        length = math.hypot(*axis.direction)
        if not 1e-9 < length < math.inf:
            raise invalid(f"{field}.{name}.direction", "three numbers, not all 0", axis.direction)
        unit = [e / length for e in axis.direction]
        still = [0.0, 0.0, 0.0]
        columns.append(unit + still if axis.kind == "position" else still + unit)
    rows = np.array([said.origin_m + said.velocity_m_s, *columns])
    moved = _in_lvlh(said, question, rows)
    try:
        return Plane(
            moved[0],
            moved[1:].T,
            np.array([said.first.low, said.second.low]),
            np.array([said.first.high, said.second.high]),
        )
    except InvalidInput as error:
        inside = {"low": "first.low", "direction": "second.direction"}.get(str(error.field), "first")
        raise invalid(f"{field}.{inside}", str(error.required), error.received) from None


def _in_lvlh(said: PlaneInput, question: SpaceQuestion, rows: Floats) -> Floats:
    """States (K, 6) of ``frame`` and ``rest`` as LVLH states: a linear map."""
    at, attitude = np.zeros(1), question.attitude
    turn, omega = attitude.rotation(at)[0], attitude.angular_velocity(at)[0]
    body = rows.reshape(-1, 2, 3) if said.frame == "body" else rows.reshape(-1, 2, 3) @ turn.T
    position, velocity = body[:, 0], body[:, 1]
    if said.rest is Rest.LVLH:
        velocity = velocity - np.cross(omega, position)
    return starts_in_lvlh(attitude, position, velocity)


def _short(direction: list[float]) -> str:
    for name, axis in _AXES.items():
        if direction == axis:
            return name
    return f"({', '.join(f'{e:g}' for e in direction)})"

"""Demands that are not convex, or are convex but no half-spaces: keep-outs, the field of view, the plume rule.

What is asked is the demand itself; :mod:`safestart.exact.space.demands.restriction` answers it by convex parts of it,
and the checker of proofs checks the demand.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from safestart.constraints.thrust_limit import Frame, Vector
from safestart.errors import invalid
from safestart.model.scenario import MAX_RANGE, Floats, number

MOST_KEEP_OUTS = 8
VIEW, PLUME = "field_of_view", "plume"
_HAIR = 1e-12
_LEAST_ANGLE, _MOST_ANGLE = math.radians(1.0), math.radians(85.0)


def _point(name: str, value: Sequence[float]) -> None:
    if len(value) != 3 or not all(math.isfinite(e) and abs(e) <= MAX_RANGE for e in value):
        raise invalid(name, f"three numbers within {MAX_RANGE:g} m", value)


def _frame(value: str) -> None:
    if value not in ("lvlh", "body"):
        raise invalid("frame", "lvlh or body", value)


@dataclass(frozen=True, slots=True)
class KeepOut:
    """The chaser stays out of a sphere (``size``: its radius, m) or a box (three half-widths along the axes)."""

    name: str
    centre: Vector
    size: tuple[float, ...]
    frame: Frame = "body"

    def __post_init__(self) -> None:
        if not 0 < len(self.name) <= 40:
            raise invalid("name", "a name of 1 to 40 characters", self.name)
        _point("centre", self.centre)
        _frame(self.frame)
        if len(self.size) not in (1, 3):
            raise invalid("size", "a radius, or three half-widths", self.size)
        for value in self.size:
            number("size", value, 1e-3, MAX_RANGE)

    def walls(self, points: Floats) -> tuple[Floats, Floats]:
        """Half-spaces normal . p <= offset outside of it, next to ``points`` (K, 3), m.

        Unit normals (K, 3), offsets (K,).

        A sphere's touches it below the point; of a box it is the face that the point is furthest beyond.
        """
        away = points - np.array(self.centre)
        if len(self.size) == 1:
            length = np.sqrt(np.square(away).sum(axis=1))
            still = length < 1e-9
            away[still], length[still] = (0.0, 1.0, 0.0), 1.0
            out, reach = away / length[:, None], np.full(len(points), self.size[0])
        else:
            half = np.array(self.size)
            axis = np.argmax(np.abs(away) - half, axis=1)
            rows = np.arange(len(points))
            out = np.zeros_like(away)
            out[rows, axis] = np.where(away[rows, axis] < 0.0, -1.0, 1.0)
            reach = half[axis]
        return -out, -(out @ np.array(self.centre)) - reach

    def room(self, point: Floats) -> float:
        """How far (m) a point (3,) is outside; of a box the largest distance beyond a face."""
        normal, offset = self.walls(point[None].copy())
        return float(offset[0] - normal[0] @ point)


@dataclass(frozen=True, slots=True)
class FieldOfView:
    """Seen from the chaser, ``point`` (m) is within ``half_angle`` rad of the camera's ``axis``, both in ``frame``."""

    axis: Vector
    half_angle: float
    point: Vector = (0.0, 0.0, 0.0)
    frame: Frame = "lvlh"

    def __post_init__(self) -> None:
        if len(self.axis) != 3 or not 1e-6 <= math.hypot(*self.axis) <= 1e6:
            raise invalid("axis", "three finite numbers, not all 0", self.axis)
        number("half_angle", self.half_angle, _LEAST_ANGLE, _MOST_ANGLE)
        _point("point", self.point)
        _frame(self.frame)

    def walls(self, count: int) -> tuple[Floats, Floats]:
        """Half-spaces that meet in a pyramid of ``count`` faces in the cone: unit normals (count, 3), offsets."""
        return self._planes(self._around(count), math.tan(self.half_angle) * math.cos(math.pi / count))

    def tangents(self, count: int, towards: Floats) -> tuple[Floats, Floats]:
        """Half-spaces that hold the cone, as :meth:`walls`: ``count`` around it and those on the side of points (K, 3).

        They lean out by a hair, so that a checker finds the cone on one side of each.
        """
        axis = np.array(self.axis) / math.hypot(*self.axis)
        sight = np.array(self.point) - towards.reshape(-1, 3)
        across = sight - np.outer(sight @ axis, axis)
        size = np.sqrt(np.square(across).sum(axis=1))
        across = across[size > 1e-9] / size[size > 1e-9, None]
        across -= np.outer(across @ axis, axis)
        slope = math.tan(self.half_angle) * (1.0 + _HAIR)
        return self._planes(np.concatenate([self._around(count), across]), slope)

    def _around(self, count: int) -> Floats:
        """Unit vectors (count, 3) across the axis."""
        axis = np.array(self.axis) / math.hypot(*self.axis)
        side = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
        side /= math.hypot(*side.tolist())
        angle = 2.0 * math.pi * np.arange(count) / count
        out: Floats = np.outer(np.cos(angle), side) + np.outer(np.sin(angle), np.cross(axis, side))
        return out

    def _planes(self, across: Floats, slope: float) -> tuple[Floats, Floats]:
        axis = np.array(self.axis) / math.hypot(*self.axis)
        normals = (slope * axis - across) / math.hypot(1.0, slope)
        return normals, normals @ np.array(self.point)

    def room(self, point: Floats) -> float:
        """How far (m) a point (3,) is inside of the cone."""
        sight, axis = np.array(self.point) - point, np.array(self.axis) / math.hypot(*self.axis)
        along = float(sight @ axis)
        across = math.hypot(*(sight - along * axis).tolist())
        return along * math.sin(self.half_angle) - across * math.cos(self.half_angle)


@dataclass(frozen=True, slots=True)
class Plume:
    """Within ``reach`` m of ``point`` no exhaust leaves within ``half_angle`` rad of the line of sight to it.

    The exhaust is opposite to the thrust: u . d <= |u| |d| cos(half_angle) for d from the point to the chaser.
    """

    half_angle: float
    reach: float
    point: Vector = (0.0, 0.0, 0.0)
    frame: Frame = "body"

    def __post_init__(self) -> None:
        number("half_angle", self.half_angle, _LEAST_ANGLE, math.radians(80.0))
        number("reach", self.reach, 1e-2, MAX_RANGE)
        _point("point", self.point)
        _frame(self.frame)


@dataclass(frozen=True, slots=True)
class Demands:
    """All demands of a question beside its faces; false where there is none."""

    keep_outs: tuple[KeepOut, ...] = ()
    view: FieldOfView | None = None
    plume: Plume | None = None

    def __bool__(self) -> bool:
        return bool(self.keep_outs) or self.view is not None or self.plume is not None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the keep-outs, then of the field of view and the plume."""
        out = tuple(one.name for one in self.keep_outs)
        return out + ((VIEW,) if self.view else ()) + ((PLUME,) if self.plume else ())

    def check(self, taken: Sequence[str]) -> None:
        """Raise ``InvalidInput`` for too many, and for names that are used twice or by the question's ``taken``."""
        if len(self.keep_outs) > MOST_KEEP_OUTS:
            raise invalid("keep_outs", f"at most {MOST_KEEP_OUTS}", len(self.keep_outs))
        names = [one.name for one in self.keep_outs]
        reserved = {*taken, VIEW, PLUME}
        wrong = sorted({name for name in names if names.count(name) > 1 or name in reserved})
        if wrong:
            raise invalid("keep_outs", "names that nothing else has, each once", wrong)

    def rooms(self, lvlh: Floats, body: Floats) -> list[tuple[str, float]]:
        """Name and margin (m) of every demand on the position of a chaser at ``lvlh`` (3,), which is ``body`` (3,)."""
        regions: list[tuple[str, KeepOut | FieldOfView]] = [(one.name, one) for one in self.keep_outs]
        if self.view is not None:
            regions.append((VIEW, self.view))
        return [(name, one.room(body if one.frame == "body" else lvlh)) for name, one in regions]


NONE = Demands()

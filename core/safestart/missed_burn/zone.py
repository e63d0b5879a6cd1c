"""Zones that must stay empty, fixed in the orbit frame: a sphere, an ellipsoid or a box."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from safestart.errors import invalid
from safestart.model.scenario import Floats

Kind = Literal["sphere", "ellipsoid", "box"]
Three = tuple[float, float, float]
MOST_ZONES = 8
_STEPS = 200
_ROUND = 1e-9
"""Axes of an ellipsoid or box are perpendicular to this share of their lengths."""


@dataclass(frozen=True, slots=True)
class Zone:
    """A body around ``centre`` (3,), m, LVLH.

    ``axes``: three vectors, m: semi-axes of an ellipsoid, half-edges of a box, perpendicular to each other; a sphere
    has its radius along x, y and z, and a radius of 0 is a point.
    """

    kind: Kind
    centre: Three
    axes: tuple[Three, Three, Three]

    def __post_init__(self) -> None:
        axes = np.array(self.axes)
        if not (np.isfinite(axes).all() and np.isfinite(self.centre).all()):
            raise invalid("zones", "finite numbers", self)
        sizes = np.linalg.norm(axes, axis=1)
        if self.kind != "sphere" and not (sizes > 0.0).all():
            raise invalid("zones.half_m", "three lengths above 0 of an ellipsoid or box", sizes.tolist())
        gram = axes @ axes.T
        off = np.abs(gram - np.diag(np.diag(gram)))
        if (off > _ROUND * np.outer(sizes, sizes)).any():
            raise invalid("zones", "axes perpendicular to each other", axes.tolist())

    @classmethod
    def sphere(cls, radius: float, centre: Three = (0.0, 0.0, 0.0)) -> Zone:
        """A ball of ``radius`` m."""
        if not (math.isfinite(radius) and radius >= 0.0):
            raise invalid("zones.radius_m", "0 or more", radius)
        return cls("sphere", centre, ((radius, 0.0, 0.0), (0.0, radius, 0.0), (0.0, 0.0, radius)))

    @property
    def blocks(self) -> tuple[Floats, NDArray[np.int64]]:
        """Columns (S, 3) of the blocks Z_k b_k, |b_k| <= 1, whose sum with the centre is the body, and their ends."""
        columns = np.array(self.axes)
        if not columns.any():
            return np.zeros((0, 3)), np.zeros(0, dtype=np.int64)
        return columns, np.array([1, 2, 3] if self.kind == "box" else [3], dtype=np.int64)

    @property
    def size(self) -> float:
        """Bound on how far the body reaches from its centre, m: the sum of the norms of its blocks."""
        columns, begin, total = np.array(self.axes), 0, 0.0
        for end in self.blocks[1].tolist():
            total += float(np.linalg.norm(columns[begin:end]))
            begin = end
        return total

    def distance(self, position: Floats) -> float:
        """Distance from a ``position`` (3,) to the body, m; 0 inside."""
        axes = np.array(self.axes)
        sizes = np.linalg.norm(axes, axis=1)
        off = position - np.array(self.centre)
        if self.kind == "sphere":
            return max(float(np.linalg.norm(off)) - float(sizes[0]), 0.0)
        local = np.abs(axes @ off) / sizes
        if self.kind == "box":
            return float(np.linalg.norm(np.maximum(local - sizes, 0.0)))
        return _to_ellipsoid(local, sizes)


POINT = Zone.sphere(0.0)
"""The target itself."""


def _to_ellipsoid(local: Floats, sizes: Floats) -> float:
    """Distance of a point in the axes of an ellipsoid: its foot is (a^2 / (a^2 + t)) p, t the root of a falling
    function (Eberly, Distance from a point to an ellipse)."""

    def beyond(t: float) -> float:
        return float(((sizes * local / (sizes**2 + t)) ** 2).sum()) - 1.0

    if beyond(0.0) <= 0.0:
        return 0.0
    low, high = 0.0, float(sizes.max() * np.linalg.norm(local))
    for _ in range(_STEPS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if beyond(middle) > 0.0 else (low, middle)
        if high - low <= 1e-15 * high:
            break
    return float(np.linalg.norm(local * high / (sizes**2 + high)))

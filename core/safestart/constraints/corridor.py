"""The line-of-sight corridor: five half-spaces fixed in the target's body frame (paper 000, eq. 4)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from safestart.model.scenario import Bools, CorridorShape, Floats

FACES = ("hold_plane", "right", "left", "top", "bottom")
"""Names of the rows of A_c: y >= r_h, then the +x, -x, +z and -z sides of the cone."""

PLANAR_FACES = 3


@dataclass(frozen=True, slots=True)
class Corridor:
    """Half-spaces ``normals @ p_B <= offsets``; ``normals`` (k, d), ``offsets`` (k,), ``lengths`` = |normals|."""

    normals: Floats
    offsets: Floats
    lengths: Floats

    @property
    def faces(self) -> tuple[str, ...]:
        """Names of the faces, in row order."""
        return FACES[: len(self.offsets)]

    def slack(self, points: Floats) -> Floats:
        """s_i = b_i - A_i p_B for points (..., d), shape (..., k); negative outside face i."""
        return self.offsets - points @ self.normals.T

    def contains(self, points: Floats) -> Bools:
        """True where every slack is >= 0, shape (...)."""
        return np.asarray((self.slack(points) >= 0.0).all(axis=-1))


@lru_cache(maxsize=64)
def corridor_of(shape: CorridorShape, dimensions: int = 2) -> Corridor:
    """Corridor of a shape in 2-D (first three faces, z = 0) or 3-D (all five)."""
    cx, cz, rh = shape.c_x, shape.c_z, shape.hold_radius
    normals = np.array(
        [[0.0, -1.0, 0.0], [1.0, -cx, 0.0], [-1.0, -cx, 0.0], [0.0, -cz, 1.0], [0.0, -cz, -1.0]]
    )
    side_x, side_z = shape.x0 - cx * rh, shape.z0 - cz * rh
    offsets = np.array([-rh, side_x, side_x, side_z, side_z])
    if dimensions == 2:
        # At z = 0 the two z faces read c_z (y - r_h) + z_0 >= 0: implied by y >= r_h.
        normals, offsets = normals[:PLANAR_FACES, :2], offsets[:PLANAR_FACES]
    normals, offsets = np.ascontiguousarray(normals), np.ascontiguousarray(offsets)
    lengths = np.sqrt((normals**2).sum(axis=1))
    for array in (normals, offsets, lengths):
        array.setflags(write=False)
    return Corridor(normals, offsets, lengths)

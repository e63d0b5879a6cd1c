"""A polyhedron fixed in the target's body frame, and the paper's line-of-sight corridor (paper 000, eq. 4)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from safestart.attitude.attitude import Attitude
from safestart.attitude.body_frame import out_of_body
from safestart.errors import invalid
from safestart.model.scenario import Bools, CorridorShape, Floats

FACES = ("hold_plane", "right", "left", "top", "bottom")
"""Names of the rows of A_c: y >= r_h, then the +x, -x, +z and -z sides of the cone."""

PLANAR_FACES = 3


@dataclass(frozen=True, slots=True)
class Corridor:
    """Half-spaces ``normals @ p_B <= offsets`` by name; ``normals`` (F, d); ``offsets`` and ``lengths`` (F,).

    d = 2 is a flight in the plane z = 0 of a body that turns about z.
    """

    normals: Floats
    offsets: Floats
    lengths: Floats
    names: tuple[str, ...]

    def slack(self, points: Floats) -> Floats:
        """s_i = b_i - A_i p_B for points (..., d), shape (..., F); negative outside face i."""
        return self.offsets - points @ self.normals.T

    def contains(self, points: Floats) -> Bools:
        """True where every slack is >= 0, shape (...)."""
        return np.asarray((self.slack(points) >= 0.0).all(axis=-1))

    def room(self, times: Floats, states: Floats, attitude: Attitude) -> tuple[Floats, Floats]:
        """Distances to the faces (T, F), m, and their rates, m/s; see :class:`safestart.constraints.constraint`.

        Raises ``InvalidInput`` if a planar corridor (d = 2) would turn out of its plane.
        """
        d = self.normals.shape[1]
        turn, omega = attitude.rotation(times), attitude.angular_velocity(times)
        if d == 2 and (turn[:, 2, :2].any() or omega[:, :2].any()):
            raise invalid("corridor", "all five faces where the target does not turn about z", "a planar one")
        # Unit normals in LVLH axes, (T, d, F), and their rates from the turn.
        normals = np.ascontiguousarray(faces_at(self.normals / self.lengths[:, None], turn).swapaxes(1, 2))
        spin = np.einsum("tji,tj->ti", turn, omega)
        if d == 2:
            turning = spin[:, 2, None, None] * np.stack([-normals[:, 1], normals[:, 0]], axis=1)
        else:
            turning = np.cross(spin[:, :, None], normals, axis=1)
        value = self.offsets / self.lengths - np.einsum("tdf,td->tf", normals, states[:, :d])
        rate = -np.einsum("tdf,td->tf", normals, states[:, 3 : 3 + d])
        return value, rate - np.einsum("tdf,td->tf", turning, states[:, :d])


def faces_at(normals: Floats, rotation: Floats) -> Floats:
    """Body-fixed normals (F, d) in LVLH axes under rotations (..., 3, 3), shape (..., F, d): the rows of A R."""
    d = normals.shape[1]
    out = np.empty((*rotation.shape[:-2], *normals.shape))
    for i in range(d):
        out[..., i] = normals[:, 0] * rotation[..., 0, i, None]
        for j in range(1, d):
            out[..., i] += normals[:, j] * rotation[..., j, i, None]
    return out


def faces_about_z(normals: Floats, angles: Floats) -> Floats:
    """The same after a turn by ``angles`` (...), rad, about z: faster, with the same bits."""
    out = np.empty((*angles.shape, *normals.shape))
    out[...] = normals
    cos, sin = np.cos(angles)[..., None], np.sin(angles)[..., None]
    out[..., 0], out[..., 1] = out_of_body(cos, sin, normals[:, 0], normals[:, 1])
    return out


def polyhedron(normals: Floats, offsets: Floats, names: tuple[str, ...]) -> Corridor:
    """The corridor of half-spaces ``normals`` (F, d) @ p_B <= ``offsets`` (F,); its arrays are read-only."""
    normals, offsets = np.ascontiguousarray(normals), np.ascontiguousarray(offsets)
    lengths = np.sqrt((normals**2).sum(axis=1))
    for array in (normals, offsets, lengths):
        array.setflags(write=False)
    return Corridor(normals, offsets, lengths, names)


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
    return polyhedron(normals, offsets, FACES[: len(offsets)])

"""Is a zonotope apart from the target's box? Separating directions are exact, also with time as third axis.

For a convex polygon or polyhedron given by generators the candidates for a separating plane are the normals of the
faces of the difference set: in the plane perpendicular to one generator, in space to two. Any direction is sound.
The answer is a lower bound on the distance to the target's centre in the maximum norm: the set is apart from the
box of half-width w wherever it exceeds w.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from safestart.model.scenario import Floats
from safestart.passive_safety.reach.rounding import SLACK


def planar_clearance(centre: Floats, gens: Floats, box: Floats) -> Floats:
    """Lower bounds (N,) on the max-norm distance of zonotopes from the origin.

    ``centre`` (N, 2), ``gens`` (N, m, 2); ``box`` (N, 2) is an axis-aligned addition. At most 0 where the set may
    hold the origin.
    """
    count, most, _ = gens.shape
    normals = np.empty((count, most + 2, 2))
    normals[:, :most, 0] = -gens[:, :, 1]
    normals[:, :most, 1] = gens[:, :, 0]
    normals[:, most:] = np.eye(2)
    length = np.abs(normals).sum(axis=2)
    reach = np.abs(np.matmul(normals, gens.transpose(0, 2, 1))).sum(axis=2)
    reach += np.matmul(np.abs(normals), box[:, :, None])[:, :, 0]
    along = np.abs(np.matmul(normals, centre[:, :, None])[:, :, 0])
    size = np.matmul(np.abs(normals), (np.abs(centre) + np.abs(gens).sum(axis=1) + box)[:, :, None])[:, :, 0]
    room = along - reach - SLACK * size
    # A generator of length 0 gives no direction.
    result: Floats = np.where(length > 0.0, room / np.where(length > 0.0, length, 1.0), -np.inf).max(axis=1)
    return result


@cache
def _pairs(count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    return np.triu_indices(count, 1)


def timed_clearance(
    centre: Floats, gens: Floats, box: Floats, clock: Floats, clock_gens: Floats, window: tuple[float, float]
) -> Floats:
    """As :func:`clearance`, for those members alone whose clock ``clock`` (N,) + ``clock_gens`` (N, m) . w lies
    in ``window``.

    Members of the third dimension: (x, y, clock). The window is exact, not an over-approximation by a box.
    """
    count, most, _ = gens.shape
    solid = np.concatenate([gens, clock_gens[:, :, None]], axis=2)
    axes = np.broadcast_to(np.eye(3), (count, 3, 3))
    edges = np.concatenate([solid, axes], axis=1)
    i, j = _pairs(most + 3)
    normals = np.cross(edges[:, i], edges[:, j])
    reach = np.abs(np.matmul(normals, solid.transpose(0, 2, 1))).sum(axis=2)
    reach += np.matmul(np.abs(normals[:, :, :2]), box[:, :, None])[:, :, 0]
    middle, half = 0.5 * (window[0] + window[1]), 0.5 * (window[1] - window[0])
    away = np.concatenate([centre, (clock - middle)[:, None]], axis=1)
    along = np.abs(np.matmul(normals, away[:, :, None])[:, :, 0])
    size = np.abs(away) + np.abs(solid).sum(axis=1)
    size[:, :2] += box
    size[:, 2] += abs(middle) + half
    slack = SLACK * np.matmul(np.abs(normals), size[:, :, None])[:, :, 0]
    room = along - reach - half * np.abs(normals[:, :, 2]) - slack
    length = np.abs(normals[:, :, :2]).sum(axis=2)
    # A direction along the clock alone either proves that the window is empty or proves nothing.
    tiny = length <= 1e-9 * np.abs(normals).sum(axis=2)
    alone = np.where(room > 0.0, np.inf, -np.inf)
    result: Floats = np.where(tiny, alone, room / np.where(tiny, 1.0, length)).max(axis=1)
    return result

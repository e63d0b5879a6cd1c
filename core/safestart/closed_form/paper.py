"""Closed-form safe-start certificate (paper 000, eqs. 8 and 9).

A start is certified when, on every face of the corridor, the slack exceeds what the rotation consumes before
full thrust has arrested it, and when it lies inside the synchronization range. NumPy only, so that the
service answers it without loading an engine.

Starts at rest in the body frame are an extension of the paper: they consume no slack, and the range limit is the one
within which thrust can hold station against the centripetal, Coriolis and gravity-gradient terms, r < a_max /
(omega_t^2 + 2 n omega_t + 3 n^2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.closed_form.blocks import row_blocks
from safestart.constraints.corridor import Corridor, corridor_of
from safestart.errors import invalid
from safestart.model.scenario import Bools, Floats, Grid, Rest, Scenario


@dataclass(frozen=True, slots=True)
class Certificate:
    """Certificate of an array of starts; leading axes are those of the points, k is the number of faces.

    ``slack`` and ``erosion`` (..., k) are in the scaling of eq. (4); ``face_margin`` (..., k) and ``margin``
    (...) are in metres (divided by the length of the face's normal); ``range_margin`` (...) is the range limit
    minus the range, inf when there is no limit. ``safe`` is ``margin > 0``.
    """

    faces: tuple[str, ...]
    slack: Floats
    slack_rate: Floats
    erosion: Floats
    face_margin: Floats
    range_margin: Floats
    range_limit: float
    margin: Floats
    safe: Bools


@dataclass(frozen=True, slots=True)
class MapCertificate:
    """Certificate of a whole grid: margin and mask (ny, nx), and the safe fraction of the corridor's points."""

    margin: Floats
    mask: Bools
    inside: Bools
    safe_fraction: float
    range_limit: float


def range_limit(scenario: Scenario, rest: Rest = Rest.LVLH) -> float:
    """Range in metres beyond which no start is certified: eq. (9), or the station-keeping bound (body rest)."""
    if rest is Rest.LVLH:
        return scenario.sync_radius
    omega, n = scenario.target.tumble_rate, scenario.target.mean_motion
    demand = omega * omega + 2.0 * n * omega + 3.0 * n * n
    return scenario.chaser.max_acceleration / demand if demand > 0.0 else math.inf


def certify(scenario: Scenario, points: Floats, rest: Rest = Rest.LVLH) -> Certificate:
    """Certify starts at rest, body-frame positions ``points`` (..., 2) or (..., 3) in metres.

    The slack rate of a start at rest in LVLH follows from dp_B/dt = -omega x p_B; s_i' = -A_i dp_B/dt.
    Raises ``InvalidInput`` when the points are not finite or have another last axis.
    """
    points = np.asarray(points, dtype=np.float64)
    if points.ndim == 0 or points.shape[-1] not in (2, 3):
        raise invalid("points", "last axis of length 2 or 3 (metres)", points.shape)
    if not np.isfinite(points).all():
        raise invalid("points", "finite coordinates in metres", "NaN or infinity")
    corridor = corridor_of(scenario.corridor, points.shape[-1])
    slack = corridor.offsets - rowwise(points, corridor.normals.T)
    slack_rate = rowwise(points, rate_matrix(corridor, scenario, rest))
    erosion = np.minimum(slack_rate, 0.0) ** 2 / (2.0 * scenario.chaser.max_acceleration)
    face_margin = (slack - erosion) / corridor.lengths
    limit = range_limit(scenario, rest)
    range_margin = limit - np.sqrt((points * points).sum(axis=-1))
    margin = np.minimum(face_margin.min(axis=-1), range_margin)
    return Certificate(
        corridor.names, slack, slack_rate, erosion, face_margin, range_margin, limit, margin, margin > 0.0
    )


def rowwise(points: Floats, matrix: Floats) -> Floats:
    """``points @ matrix`` with the same bits for a single start (..., d) as for one among many.

    BLAS multiplies a matrix of many rows with fused multiply-adds, and a single row by another routine without them.
    The last bit differs, and near zero the verdict. So a single row is multiplied as one of two.
    """
    rows = points.reshape(-1, points.shape[-1])
    product = np.repeat(rows, 2, axis=0) @ matrix if len(rows) == 1 else rows @ matrix
    found: Floats = product[: len(rows)].reshape(*points.shape[:-1], matrix.shape[-1])
    return found


def rate_matrix(corridor: Corridor, scenario: Scenario, rest: Rest) -> Floats:
    """Matrix M (d, k) with s' = p @ M for a start at rest: s_i' = A_i (omega x p_B), 0 for body rest."""
    omega = scenario.target.tumble_rate if rest is Rest.LVLH else 0.0
    rate = np.zeros_like(corridor.normals.T)
    rate[0] = omega * corridor.normals[:, 1]
    rate[1] = -omega * corridor.normals[:, 0]
    return rate


def certify_grid(scenario: Scenario, grid: Grid, rest: Rest = Rest.LVLH) -> MapCertificate:
    """Certify every point of a grid: arrays (ny, nx), row-major ``[iy][ix]``.

    The arithmetic is :func:`certify`'s, face by face over the grid's axes without the per-face report.
    """
    x, y = grid.axes(scenario.corridor)
    corridor = corridor_of(scenario.corridor)
    rate = rate_matrix(corridor, scenario, rest)
    limit = range_limit(scenario, rest)
    twice = 2.0 * scenario.chaser.max_acceleration
    size = (len(y), len(x))
    margin, inside = np.empty(size), np.empty(size, bool)
    for rows in row_blocks(*size):
        margin[rows], inside[rows] = _margins(corridor, rate, limit, twice, x, y[rows, None])
    mask = margin > 0.0
    count = int(np.count_nonzero(inside))
    fraction = float(np.count_nonzero(mask)) / count if count else 0.0
    return MapCertificate(margin, mask, inside, fraction, limit)


def _margins(
    corridor: Corridor, rate: Floats, limit: float, twice: float, x: Floats, y: Floats
) -> tuple[Floats, Bools]:
    """Margin and whether it lies in the corridor, (ny, nx), for x (nx,) and y (ny, 1)."""
    margin = limit - np.sqrt(x * x + y * y)
    least = np.full(margin.shape, np.inf)
    for i in range(len(corridor.offsets)):
        slack = (corridor.offsets[i] - corridor.normals[i, 0] * x) - corridor.normals[i, 1] * y
        np.minimum(least, slack, out=least)
        drop = np.minimum(rate[0, i] * x + rate[1, i] * y, 0.0)
        slack -= drop * drop / twice
        slack /= corridor.lengths[i]
        np.minimum(margin, slack, out=margin)
    return margin, least >= 0.0

"""The closed-form certificate of one start in plain floats: the bits of ``certify`` in a tenth of its time.

NumPy's fixed cost per call is several times that of the few dozen operations one start needs. Values that depend only
on the scenario are computed once and cached. NumPy computes the products, since BLAS fuses them; the rest rounds the
same in Python and NumPy.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from safestart.closed_form.paper import range_limit, rate_matrix
from safestart.constraints.corridor import corridor_of
from safestart.model.scenario import Chaser, CorridorShape, Floats, Rest, Scenario, Target

Shape = tuple[float, float, float, float, float]
"""The fields of a ``CorridorShape``, in its order."""


@dataclass(frozen=True, slots=True)
class Prepared:
    """A scenario's faces (their names, offsets and lengths of the normals), its range limit, and one matrix (d, 2 k).

    A start times the matrix gives the part of each slack that depends on it, then its slack rates.
    """

    faces: tuple[str, ...]
    rows: tuple[tuple[float, float], ...]
    limit: float
    twice_thrust: float
    matrix: Floats


class PointCertificate(NamedTuple):
    """Slack and margin by face, range margin and smallest margin of one start, in metres."""

    slack: list[float]
    face_margin: list[float]
    range_margin: float
    margin: float


@lru_cache(maxsize=1024)
def prepare(
    omega_t_deg_s: float, a_max: float, mean_motion: float, shape: Shape, rest: Rest, dimensions: int
) -> Prepared:
    """The scenario's values that the certificate of a planar (2) or spatial (3) start needs."""
    scenario = Scenario(
        Target(math.radians(omega_t_deg_s), mean_motion), Chaser(a_max), CorridorShape(*shape)
    )
    corridor = corridor_of(scenario.corridor, dimensions)
    return Prepared(
        corridor.names,
        tuple(zip(corridor.offsets.tolist(), corridor.lengths.tolist(), strict=True)),
        range_limit(scenario, rest),
        2.0 * a_max,
        np.concatenate([corridor.normals.T, rate_matrix(corridor, scenario, rest)], axis=1),
    )


def certify_point(prepared: Prepared, point: tuple[float, ...]) -> PointCertificate:
    """Certificate of one start at (x, y) or (x, y, z), bit for bit that of :func:`certify`."""
    # Two rows: see ``rowwise``.
    taken = np.array((point, point)).dot(prepared.matrix)[0].tolist()
    slack = []
    face_margin = []
    for k, (offset, length) in enumerate(prepared.rows):
        left, rate = offset - taken[k], taken[k + len(prepared.rows)]
        slack.append(left)
        face_margin.append(
            left / length if rate >= 0.0 else (left - rate * rate / prepared.twice_thrust) / length
        )
    squares = 0.0
    for value in point:  # not ``sum``, which rounds differently from Python 3.12 on
        squares += value * value
    range_margin = prepared.limit - math.sqrt(squares)
    return PointCertificate(slack, face_margin, range_margin, min(*face_margin, range_margin))

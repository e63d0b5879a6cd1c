"""The closed-form certificate of one start in plain floats.

NumPy's fixed cost per call is several times that of the few dozen multiplications one start needs. What depends on the
scenario alone is taken from the core's own arrays once and kept; a start is then :func:`certify`'s arithmetic, face by
face. The two may round differently, so a start within :data:`NEAR` (m) of any boundary, or with two constraints that
close to binding, is left to ``certify``: verdict, violated faces and binding constraint are always the same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from safestart.certificates.closed_form import certify, range_limit
from safestart.corridor import corridor_of
from safestart.scenario import Chaser, CorridorShape, Rest, Scenario, Target

NEAR = 1e-6

Shape = tuple[float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class Prepared:
    """Scenario, its faces' names, its range limit, and one row of floats per face.

    A row is offset, normal (3), slack rate per metre (3), length of the normal; z entries are 0 in the plane.
    """

    scenario: Scenario
    faces: tuple[str, ...]
    limit: float
    twice_thrust: float
    rows: tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True)
class PointCertificate:
    """Slack and margin by face, range margin and smallest margin of one start, in metres."""

    slack: list[float]
    face_margin: list[float]
    range_margin: float
    margin: float


@lru_cache(maxsize=1024)
def prepare(
    omega_t_deg_s: float, a_max: float, mean_motion: float, shape: Shape, rest: Rest, spatial: bool
) -> Prepared:
    """What the certificate of a start needs to know of its scenario."""
    scenario = Scenario(
        Target(math.radians(omega_t_deg_s), mean_motion), Chaser(a_max), CorridorShape(*shape)
    )
    dimensions = 3 if spatial else 2
    corridor = corridor_of(scenario.corridor, dimensions)
    # The slack rate is linear in the position: its coefficients are the rates at the unit vectors.
    rates = certify(scenario, np.eye(dimensions), rest).slack_rate.T
    flat = (0.0,) * (3 - dimensions)
    rows = tuple(
        (offset, *normal, *flat, *rate, *flat, length)
        for offset, normal, rate, length in zip(
            corridor.offsets.tolist(),
            corridor.normals.tolist(),
            rates.tolist(),
            corridor.lengths.tolist(),
            strict=True,
        )
    )
    return Prepared(scenario, corridor.faces, range_limit(scenario, rest), 2.0 * a_max, rows)


def certify_point(prepared: Prepared, x: float, y: float, z: float) -> PointCertificate | None:
    """Certificate of one start; None where rounding could decide and ``certify`` has to."""
    slack = []
    face_margin = []
    for offset, a, b, c, ra, rb, rc, length in prepared.rows:
        left = offset - (a * x + b * y + c * z)
        rate = ra * x + rb * y + rc * z
        margin = left / length if rate >= 0.0 else (left - rate * rate / prepared.twice_thrust) / length
        if -NEAR < left < NEAR:
            return None
        slack.append(left)
        face_margin.append(margin)
    range_margin = prepared.limit - math.sqrt(x * x + y * y + z * z)
    ordered = sorted((*face_margin, range_margin))
    margin = ordered[0]
    if -NEAR < margin < NEAR or ordered[1] - margin < NEAR * (1.0 + abs(margin)):
        return None
    return PointCertificate(slack, face_margin, range_margin, margin)

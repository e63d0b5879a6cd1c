"""The closed-form certificate of one start in plain floats.

NumPy's fixed cost per call is several times that of the few dozen multiplications one start needs. What depends on the
scenario alone is taken from the core once and kept; a start is then the arithmetic of ``certify``, face by
face. The two may round differently, so a start within :data:`NEAR` (m) of any boundary, or with two constraints that
close to binding, is left to ``certify``: verdict, violated faces and binding constraint are always the same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

from safestart.closed_form.paper import range_limit, rate_matrix
from safestart.constraints.corridor import corridor_of
from safestart.model.scenario import Chaser, CorridorShape, Rest, Scenario, Target

NEAR = 1e-6

Shape = tuple[float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class Prepared:
    """Scenario, its faces' names, its range limit, and one row of floats per face.

    A row is offset, normal (3, z = 0 in the plane), slack rate per metre of x and of y, length of the normal.
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
    corridor = corridor_of(scenario.corridor, 3 if spatial else 2)
    flat = () if spatial else (0.0,)
    rates = rate_matrix(corridor, scenario, rest)
    rows = tuple(
        (offset, *normal, *flat, across, along, length)
        for offset, normal, across, along, length in zip(
            corridor.offsets.tolist(),
            corridor.normals.tolist(),
            rates[0].tolist(),
            rates[1].tolist(),
            corridor.lengths.tolist(),
            strict=True,
        )
    )
    return Prepared(scenario, corridor.names, range_limit(scenario, rest), 2.0 * a_max, rows)


def certify_point(prepared: Prepared, x: float, y: float, z: float) -> PointCertificate | None:
    """Certificate of one start; None where rounding could decide and ``certify`` has to."""
    slack = []
    face_margin = []
    for offset, a, b, c, ra, rb, length in prepared.rows:
        left = offset - (a * x + b * y + c * z)
        rate = ra * x + rb * y
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

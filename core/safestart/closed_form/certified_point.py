"""`certified` for one start in plain floats: NumPy's fixed cost per call is several times the arithmetic of one start.

Values that depend only on the scenario are computed once and cached. The arithmetic is that of
:func:`safestart.closed_form.certified.certify`, operation by operation: both give the same bits. So products of
complex numbers and squares are written out: the first may be fused, ``**`` calls the C library's ``pow``.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

from safestart.closed_form.certified import FARTHEST, OUT_OF_REACH, ROUNDING, longest_range
from safestart.closed_form.family import DEGREE, SMOOTH_STEP
from safestart.closed_form.members import BRAKE, Faces
from safestart.closed_form.rates import Rates, rates_of
from safestart.errors import invalid
from safestart.model.scenario import Chaser, CorridorShape, Rest, Scenario, Target

_STEP: list[float] = SMOOTH_STEP[1:DEGREE].tolist()


class PointCertificate(NamedTuple):
    """One start's verdict, margin in metres, binding constraint, and the manoeuvre's parameters, as in `Certified`."""

    go: bool
    margin: float
    binding: str
    member: int
    drop: float


@dataclass(frozen=True, slots=True)
class Prepared:
    """Shared numbers, faces as (name, offset, a, b, c) with unit normals, range limit in m (m), members as lists."""

    rates: Rates
    faces: tuple[tuple[str, float, float, float, float], ...]
    limit: float
    reach: list[float]
    inner: list[list[complex]]
    drop: list[float]


@lru_cache(maxsize=1024)
def prepare(
    omega: float, mean_motion: float, a_max: float, shape: CorridorShape, rest: Rest, spatial: bool
) -> Prepared:
    """The scenario's values that a start's certificate needs, rates in rad/s, thrust in m/s^2.

    Raises ``InvalidInput`` outside the scenario's bounds.
    """
    scenario = Scenario(Target(omega, mean_motion), Chaser(a_max), shape)
    rates = rates_of(scenario, rest)
    faces = Faces.of(shape, 3 if spatial else 2)
    flat = () if spatial else (0.0,)
    rows = tuple(
        (name, offset, *normal, *flat)
        for name, normal, (offset,) in zip(
            faces.names, faces.normals.tolist(), faces.offsets.tolist(), strict=True
        )
    )
    family = rates.family
    return Prepared(
        rates,
        rows,
        longest_range(rates),
        family.reach.tolist(),
        family.inner.T.tolist(),
        family.drop.tolist(),
    )


def certify_point(given: Prepared, x: float, y: float, z: float = 0.0) -> PointCertificate:
    """The certificate of one start, body-frame position in metres, z = 0 unless ``given`` is spatial.

    Raises ``InvalidInput`` when a coordinate is not finite or beyond ``FARTHEST``.
    """
    if not (abs(x) <= FARTHEST and abs(y) <= FARTHEST and abs(z) <= FARTHEST):
        raise invalid("point", f"finite coordinates within {FARTHEST:g} m", (x, y, z))
    rates = given.rates
    room = [offset - (a * x + b * y + c * z) for _, offset, a, b, c in given.faces]
    least = min(room)
    if least <= ROUNDING:
        return PointCertificate(False, least - ROUNDING, given.faces[room.index(least)][0], BRAKE, 0.0)
    square = x * x + y * y
    radius = math.sqrt(square)
    sway = abs(z) * rates.sway
    rho = math.inf if sway >= 1.0 else radius * rates.scale / math.sqrt(1.0 - sway * sway)
    best, binding, member, drop = -math.inf, -1, BRAKE, 0.0
    if rates.omega == 0.0:
        pull = 3.0 * x * rates.sway
        if pull * pull + sway * sway <= 1.0:
            best, binding = least, room.index(least)
    elif rho <= rates.brake_limit:
        best, binding = _stop(given, room, x, y, z, rho)
    choices = [(rho, False)]
    if z != 0.0 and sway < 1.0:
        choices.append((math.sqrt(square + z * z) * rates.scale / (1.0 - sway), True))
    for value, draw in choices:
        k = bisect_left(given.reach, value)
        if k == len(given.reach):
            continue
        lost = given.drop[k] if draw else 0.0
        found = _turned(given, room, (x, y), given.inner[k], [z - z * lost * s for s in _STEP], best)
        if found:
            (best, binding), member, drop = found, k, lost
    if binding < 0:
        short = min(given.limit - math.sqrt(square + z * z), 0.0) - ROUNDING
        return PointCertificate(False, short, OUT_OF_REACH, BRAKE, 0.0)
    margin = best - ROUNDING
    return PointCertificate(margin > 0.0, margin, given.faces[binding][0], member, drop)


def _stop(given: Prepared, room: list[float], x: float, y: float, z: float, rho: float) -> tuple[float, int]:
    """Least room and its face while braking from (x, y, z): at the start or at the stop."""
    rates = given.rates
    beta = 0.0
    if rates.speed > 0.0:
        spare = 1.0 - rates.lost * rho
        across = rates.across * rho
        squared = spare * spare - across * across
        speed = rates.speed * rates.speed
        rest = math.sqrt(max(squared - 2.0 * rates.turning * speed * (rho * rho), 0.0))
        beta = speed * rho / (math.sqrt(squared) + rest)
    end_x, end_y = x + beta * y, y - beta * x
    best, binding = math.inf, 0
    for i, (_, offset, a, b, c) in enumerate(given.faces):
        left = min(room[i], offset - (a * end_x + b * end_y + c * z))
        if left < best:
            best, binding = left, i
    return best, binding


def _turned(
    given: Prepared,
    room: list[float],
    place: tuple[float, float],
    inner: list[complex],
    heights: list[float],
    floor: float,
) -> tuple[float, int] | None:
    """Least room and its face over the control points, ``place`` times ``inner``; None if it is at most ``floor``."""
    best, binding = math.inf, 0
    x, y = place
    # Written out: a loop over the five points takes twice as long.
    p, q, r, s, t = inner
    pr, qr, rr, sr, tr = p.real, q.real, r.real, s.real, t.real
    pi, qi, ri, si, ti = p.imag, q.imag, r.imag, s.imag, t.imag
    px, qx, rx, sx, tx = x * pr - y * pi, x * qr - y * qi, x * rr - y * ri, x * sr - y * si, x * tr - y * ti
    py, qy, ry, sy, ty = x * pi + y * pr, x * qi + y * qr, x * ri + y * rr, x * si + y * sr, x * ti + y * tr
    pz, qz, rz, sz, tz = heights
    for i, (_, offset, a, b, c) in enumerate(given.faces):
        outward = max(
            a * px + b * py + c * pz,
            a * qx + b * qy + c * qz,
            a * rx + b * ry + c * rz,
            a * sx + b * sy + c * sz,
            a * tx + b * ty + c * tz,
        )
        left = min(room[i], offset - outward)
        if left < best:
            if left <= floor:
                return None
            best, binding = left, i
    return best, binding

"""LVLH about the true Earth along a target's course: its axes at the nodes, and how fast it can turn between them.

A vector z that does not move in LVLH has, in inertial axes, y'' = R'(omega x (omega x z) + omega' x z), so

    |y''| <= W |z|,     W = |omega|^2 + |omega'|.

omega = (3 B z w / (r^4 h), 0, h / r^2) but for a sign, B = mu J2 R^2, w the z part of the orbit's normal. J2's torque
changes h by at most 3/2 B/r^3 per second, and energy is kept: with r >= r_0 and h >= h_0,

    v^2 <= 2 E + 2 mu/r_0 + B/r_0^3,     r'^2 = v^2 - h^2/r^2 <= 2 E + mu^2/h_0^2 + B/r_0^3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.dynamics.two_body import J2
from safestart.dynamics.two_body_kernel import frame_of
from safestart.model.orbit import EARTH_RADIUS as RADIUS
from safestart.model.orbit import MU
from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled

BULGE = MU * J2 * RADIUS**2
_LOOSE = 0.005
"""The checker encloses h step by step, and so in wider bounds than those of the nodes."""


@dataclass(frozen=True, slots=True)
class Turning:
    """Bounds along a course: ``spin`` on |omega|, rad/s; ``bend`` on W, 1/s^2."""

    spin: float
    bend: float


def turning_of(course: Floats, lowest: float) -> Turning:
    """Bounds along a ``course`` (T, 6) that stays above ``lowest`` m."""
    momenta = np.linalg.norm(np.cross(course[:, :3], course[:, 3:]), axis=1)
    least, most = (1.0 - _LOOSE) * float(momenta.min()), (1.0 + _LOOSE) * float(momenta.max())
    r, v = course[0, :3], course[0, 3:]
    size = float(np.linalg.norm(r))
    twice = float(v @ v) - 2.0 * MU / size + BULGE / size**3 * (3.0 * (r[2] / size) ** 2 - 1.0)
    speed = math.sqrt(twice + 2.0 * MU / lowest + BULGE / lowest**3)
    climb = math.sqrt(max(twice + (MU / least) ** 2 + BULGE / lowest**3, 0.0))
    tilt = 1.5 * BULGE / (lowest**3 * least)
    spin = math.hypot(most / lowest**2, tilt)
    tilting = 3.0 * BULGE / (lowest**3 * least) * (5.0 * speed / lowest + 2.0 * tilt)
    turning = 1.5 * BULGE / lowest**5 + 2.0 * most * climb / lowest**3
    return Turning(spin, spin**2 + math.hypot(tilting, turning))


@compiled()
def frames_along(course: Floats) -> Floats:
    """LVLH axes as rows (T, 3, 3), inertial, along a course (T, 6)."""
    out, omega = np.empty((len(course), 3, 3)), np.empty(3)
    for t in range(len(course)):
        frame_of(course[t], out[t], omega)
    return out

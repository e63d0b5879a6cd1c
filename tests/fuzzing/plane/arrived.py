"""Whether what is printed about the time after the end is true, of the document's own flight: the stop is sampled.

Motion by matrix exponentials, thrust by the equations of motion in the body frame written down again. Samples cannot
show that it is true; a stop that takes too much thrust at one of them, or comes too near to a face, is false.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tests.fuzzing.plane.decided import Truth, steps_of
from tests.fuzzing.plane.printed import Printed

_TOLERANCE = 1e-9


def truth_after(claim: Printed, document: dict[str, Any]) -> Truth:
    """ "true" means: nothing was found against it."""
    d, w, n, a_max = claim.d, claim.rates[0], claim.motions[0], claim.thrusts[0]
    if not (claim.stop > 0.0 and claim.after > 0.0):
        return "false"
    state = np.array(claim.start)
    phi, held = steps_of(n, claim.dt, d, 1)
    for u in document["thrust_m_s2"]:
        state = phi[1] @ state + held[1] @ np.array(u)
    end = claim.dt * len(document["thrust_m_s2"])
    place, speed = np.zeros(3), np.zeros(3)
    c, s = math.cos(w * end), math.sin(w * end)
    turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    place[:d], speed[:d] = state[:d], state[d:]
    place, speed = turn @ place, turn @ speed
    speed -= np.cross([0.0, 0.0, w], place)
    stopping = claim.stop * np.linspace(0.0, 1.0, 200)
    standing = claim.stop + 2.0 * math.pi / max(w, 1e-4) * np.linspace(0.0, 1.0, 200)
    for times, moving in ((stopping, True), (standing, False)):
        share = times / claim.stop if moving else np.ones(len(times))
        q = place + np.outer(claim.stop * (share - share**2 / 2.0), speed)
        v = np.outer(1.0 - share, speed)
        pull = -speed / claim.stop if moving else np.zeros(3)
        spin = np.array([0.0, 0.0, w + n])
        angle = w * (end + times)
        radial = np.stack([np.cos(angle), -np.sin(angle), 0.0 * angle], axis=-1)
        gravity = n * n * (3.0 * radial * (radial * q).sum(axis=-1, keepdims=True) - q)
        u = pull + 2.0 * np.cross(spin, v) + np.cross(spin, np.cross(spin, q)) - gravity
        if np.linalg.norm(u, axis=-1).max() > a_max * (1.0 + _TOLERANCE) + 1e-15:
            return "false"
        room = [q[:, 1] - claim.plane]
        for axis, (slope, width) in zip((0, 2), claim.sides, strict=False):
            side = width + slope * (q[:, 1] - claim.plane) - np.abs(q[:, axis])
            room.append(side / math.hypot(1.0, slope))
        if np.min(room) < claim.after - 1e-7 * (1.0 + float(np.abs(q).max())):
            return "false"
        fast = np.linalg.norm(v + np.cross([0.0, 0.0, w], q), axis=-1).max()
        if claim.speed is not None and fast > claim.speed + 1e-9:
            return "false"
    return "true"

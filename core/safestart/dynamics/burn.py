"""A burn, an impulse or a held thrust, whose size and direction are off.

Compiled twins: :mod:`safestart.dynamics.burn_kernel` in space, ``simulation.noise.delivered`` in the plane.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.model.scenario import Floats


def frame(vector: Floats) -> tuple[Floats, Floats, Floats]:
    """Unit vectors, each (3,): along a vector that is not 0, and two across it."""
    along = vector / np.linalg.norm(vector)
    other = np.eye(3)[int(np.argmin(np.abs(along)))]
    one = np.cross(along, other)
    one /= np.linalg.norm(one)
    return along, one, np.cross(along, one)


def misdirected(burn: Floats, angle: float, aside: Floats, share: float = 1.0) -> Floats:
    """``share`` of a ``burn`` (3,) that is not 0, turned by ``angle`` (rad) towards ``aside``, a unit vector across it:
    share |b| (cos(angle) b / |b| + sin(angle) aside), in the burn's unit."""
    size = float(np.linalg.norm(burn))
    off: Floats = size * share * (math.cos(angle) * (burn / size) + math.sin(angle) * aside)
    return off


def scattered(burn: Floats, size_sigma: float, angle_sigma: float, drawn: Floats) -> Floats:
    """A ``burn`` (3,) with drawn errors: scaled, and turned about two axes across it; nothing stays nothing.

    ``size_sigma`` relative, ``angle_sigma`` in rad; ``drawn`` (3,): size and the two turns, standard normals.
    """
    if float(np.linalg.norm(burn)) == 0.0:
        return burn
    _, one, two = frame(burn)
    tilt = angle_sigma * (drawn[1] * one + drawn[2] * two)
    angle = float(np.linalg.norm(tilt))
    aside = tilt / angle if angle > 0.0 else tilt
    return misdirected(burn, angle, aside, 1.0 + size_sigma * float(drawn[0]))

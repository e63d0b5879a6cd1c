"""The switch from mode 1 to mode 2: the published octagon, or the true circle of 100 m."""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from safestart.model.scenario import Floats

GAP_GUARD, GAP_DIAGONAL = 100.0, 141.1
"""Guard octagon of mode 1 -> 2: |x|, |y| <= 100 m and |x +- y| <= 141.1 m (100 sqrt 2, rounded as published)."""


class Guard(StrEnum):
    """Where mode 2 begins: ``octagon`` as in the competition, ``circle`` as in the text of paper 003."""

    OCTAGON = "octagon"
    CIRCLE = "circle"


def octagon(half: float, diagonal: float) -> tuple[Floats, Floats]:
    """Rows (8, 2) and limits (8,) of |a|, |b| <= half, |a +- b| <= diagonal."""
    rows = np.array([[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, -1], [1, -1], [-1, 1]], dtype=np.float64)
    return rows, np.array([half] * 4 + [diagonal] * 4)


FACES, FACE_LIMITS = octagon(GAP_GUARD, GAP_DIAGONAL)
"""Guard octagon: rows (8, 2) on the position, limits (8,) in metres."""

FACE_NAMES = ("x=100", "x=-100", "y=100", "y=-100", "x+y=141.1", "x+y=-141.1", "x-y=141.1", "x-y=-141.1")
"""Names of the faces, in the order of :data:`FACES`."""

COMPASS = np.stack([np.cos(np.arange(64) * np.pi / 32), np.sin(np.arange(64) * np.pi / 32)], axis=1)
"""64 unit directions (64, 2)."""

COMPASS_STRETCH = 1.0 / np.cos(np.pi / 64.0) * (1.0 + 1e-15)
"""A length is at most this factor times its greatest component along :data:`COMPASS`."""


def depth(guard: Guard, positions: Floats) -> Floats:
    """Excess (...,) of ``positions`` (..., 2) over the guard, m (octagon: of its worst face): negative inside."""
    if guard is Guard.CIRCLE:
        circle: Floats = np.hypot(positions[..., 0], positions[..., 1]) - GAP_GUARD
        return circle
    x, y = np.abs(positions[..., 0]), np.abs(positions[..., 1])
    result: Floats = np.maximum(np.maximum(x, y) - GAP_GUARD, x + y - GAP_DIAGONAL)
    return result


def gradient(guard: Guard, positions: Floats) -> Floats:
    """Derivative (..., 2) of :func:`depth`."""
    if guard is Guard.CIRCLE:
        radial: Floats = positions / np.hypot(positions[..., :1], positions[..., 1:])
        return radial
    result: Floats = FACES[(positions @ FACES.T - FACE_LIMITS).argmax(axis=-1)]
    return result


def supports(guard: Guard) -> tuple[Floats, Floats]:
    """Rows (r, 2) and limits (r,): a position beyond any of them is proved to be outside the guard."""
    return (COMPASS, np.full(len(COMPASS), GAP_GUARD)) if guard is Guard.CIRCLE else (FACES, FACE_LIMITS)

"""The manoeuvres of `certified` in dimensionless form, and the reach of each (docs/theory/certified.md).

In the plane of the spin the position in the body frame is a complex number q = x + i y. With the body's inertial rate
W = omega_t + n and time counted in 1/W, a chaser that follows q needs the thrust

    u = q'' + 2 i q' - g q - (3/2) nu^2 e^{i phase(t)} conj(q),    nu = n / W,  g = 1 + nu^2 / 2.

A member flies q(t) = p h(t / S), p the start and h a Bezier curve of degree 6 with h(0) = 1, h'(0) = -i lambda S and
h'(1) = 0, and stands still from S on. ``lambda`` is omega_t / W for a start at rest in LVLH, 0 for one at rest in the
body frame. Everything is proportional to p: the chaser stays in the hull of the control points p h_j, and member k can
be flown by a thrust a from every start within r = a reach_k / W^2.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from safestart.model.scenario import Floats

Complexes = np.ndarray[tuple[int, ...], np.dtype[np.complex128]]

DEGREE = 6
SPANS = np.linspace(0.3, 3.6, 34)
"""S of every member, in 1/W: the angle in radians by which the body turns during it."""

# Control points 2 to 5 (the last two coincide), each 1 + c S + c' S^2 + c'' S^3: found by a cone program that maximises
# the reach in a cone of slope 1.5. The certificate does not depend on that program: the reach of each curve is bounded
# anew.
FROM_LVLH = np.array(
    [
        [-0.0079 - 0.2868j, -0.0434 - 0.0059j, 0.0012 - 0.0011j],
        [-0.0927 - 0.3850j, -0.0585 - 0.0006j, -0.0059 + 0.0115j],
        [-0.0736 - 0.3976j, -0.1554 + 0.0291j, 0.0242 + 0.0164j],
        [-0.0763 - 0.4108j, -0.1914 + 0.1068j, 0.0358 - 0.0027j],
    ]
)
"""For lambda = 1: a start at rest in LVLH without orbital motion."""
FROM_BODY = np.array(
    [
        [0.0307 - 0.0249j, -0.0388 + 0.0155j, 0.0136 - 0.0076j],
        [0.0375 - 0.1256j, -0.0355 + 0.1502j, 0.0056 - 0.0496j],
        [-0.0141 - 0.1489j, 0.0535 + 0.1260j, -0.0230 - 0.0347j],
        [-0.0161 - 0.1741j, 0.0358 + 0.1408j, -0.0189 - 0.0360j],
    ]
)
"""For lambda = 0: a start at rest in the body frame. Values between mix the two linearly."""

PIECES = 5
# Cross-track: z = z0 (1 - drop (3 s^2 - 2 s^3)), its control points and the largest |z''| at drop 1.
SMOOTH_STEP = np.array([0.0, 0.0, 0.2, 0.5, 0.8, 1.0, 1.0])
STEEPEST = 6.0


def _difference(degree: int) -> Floats:
    """Control points of the derivative of a Bezier curve of ``degree``, shape (degree, degree + 1)."""
    return degree * (np.eye(degree, degree + 1, 1) - np.eye(degree, degree + 1))


def _raise(degree: int) -> Floats:
    """Control points of the same curve at one degree more, shape (degree + 2, degree + 1)."""
    share = np.arange(degree + 2) / (degree + 1)
    return (
        np.eye(degree + 2, degree + 1) * (1.0 - share)[:, None]
        + np.eye(degree + 2, degree + 1, -1) * share[:, None]
    )


def _subdivide(degree: int, pieces: int) -> Floats:
    """Control points of the curve on equal pieces of [0, 1], shape (pieces (degree + 1), degree + 1): blossoms."""
    rows = []
    for piece in range(pieces):
        for late in range(degree + 1):
            weights = np.ones(1)
            for turn in range(degree):
                t = (piece + (turn < late)) / pieces
                weights = np.append(weights * (1.0 - t), 0.0) + np.append(0.0, weights * t)
            rows.append(weights)
    return np.array(rows)


FIRST = _raise(DEGREE - 1) @ _difference(DEGREE)
"""Control points (7) of the derivative from those (7) of a curve, both of degree 6."""
SECOND = _raise(DEGREE - 1) @ _raise(DEGREE - 2) @ _difference(DEGREE - 1) @ _difference(DEGREE)


def _shapes(speed: float) -> Complexes:
    """Control points (7, K) of all members."""
    shape = np.ones((DEGREE + 1, len(SPANS)), dtype=np.complex128)
    shape[1] -= 1j * speed / DEGREE * SPANS
    shape[2:6] += (speed * FROM_LVLH + (1.0 - speed) * FROM_BODY) @ SPANS ** np.arange(1, 4)[:, None]
    shape[6] = shape[5]
    return shape


_SPLIT = _subdivide(DEGREE, PIECES)


def _pieces(shape: Complexes) -> tuple[Complexes, Complexes]:
    """Control points on the pieces of h and of h'' + 2 i h', both (35, K); linear in ``shape``."""
    return _SPLIT @ shape, _SPLIT @ (SECOND @ shape / SPANS**2 + 2j * (FIRST @ shape) / SPANS)


_AT_REST = (_shapes(0.0), *_pieces(_shapes(0.0)))
_MOVING = tuple(
    moving - still for moving, still in zip((_shapes(1.0), *_pieces(_shapes(1.0))), _AT_REST, strict=True)
)


@dataclass(frozen=True, slots=True)
class Family:
    """All members for one pair of rates: control points ``shape`` (7, K) and ``reach`` (K,), which never falls.

    ``inner`` (5, K) are the control points 1 to 5: the first is the start, the last repeats the one before.
    ``drop`` (K,) is the share of its cross-track distance that a chaser loses along the member when this costs it as
    much thrust for each metre of z as the member costs for each metre in the plane.
    """

    shape: Complexes
    reach: Floats
    inner: Complexes
    drop: Floats


@lru_cache(maxsize=1024)
def family_of(speed: float, nu: float) -> Family:
    """The members on a circular orbit for ``speed`` (lambda) and ``nu`` (n / W), both in [0, 1]."""
    return family_under(speed, 1.0 + 0.5 * nu * nu, 1.5 * nu * nu)


@lru_cache(maxsize=1024)
def family_under(speed: float, turning: float, gradient: float) -> Family:
    """The members where g is ``turning`` and all that depends on the phase is at most ``gradient`` |q|.

    The thrust of a member is a polynomial apart from the last term, whose length is ``gradient`` |q|. Both are bounded
    by their control points on :data:`PIECES` pieces, for every p and every phase; standing still takes at most
    (g + gradient) |h(1)|.
    """
    shape, hull, pushed = (still + speed * moving for still, moving in zip(_AT_REST, _MOVING, strict=True))
    moving = (np.abs(pushed - turning * hull) + gradient * np.abs(hull)).max(axis=0)
    standing = (turning + gradient) * np.abs(shape[DEGREE])
    reach = 1.0 / np.maximum(moving, standing)
    # A start takes the first member that reaches it, so no member's reach may exceed that of a later one.
    reach = np.minimum.accumulate(reach[::-1])[::-1]
    drop = np.minimum(1.0, SPANS**2 / (STEEPEST * reach))
    inner = np.ascontiguousarray(shape[1:DEGREE])
    for array in (shape, reach, inner, drop):
        array.setflags(write=False)
    return Family(shape, reach, inner, drop)

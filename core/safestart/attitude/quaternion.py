"""Unit quaternions as attitudes: scalar first, (s, v), with r_B = C r_L, C = (s^2 - v.v) I + 2 v v^T - 2 s [v]x.

The body is turned from the reference by the angle 2 acos(s) about v. Arrays (..., 4) broadcast.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from safestart.errors import invalid
from safestart.model.scenario import Floats


def unit_quaternion(name: str, value: Sequence[float]) -> tuple[float, float, float, float]:
    """Four finite numbers, not all 0, scaled to unit length; raises ``InvalidInput`` under ``name`` otherwise."""
    required = "four finite numbers, scalar first, not all 0"
    if len(value) != 4 or not all(isinstance(e, int | float | np.floating) for e in value):
        raise invalid(name, required, value)
    size = math.hypot(*(float(e) for e in value))
    if not 1e-150 < size < 1e150:
        raise invalid(name, required, value)
    s, x, y, z = (float(e) / size for e in value)
    return s, x, y, z


def matrix_of(quaternions: Floats) -> Floats:
    """C (..., 3, 3) of unit quaternions (..., 4): reference coordinates to body coordinates."""
    s, x, y, z = np.moveaxis(np.asarray(quaternions, dtype=np.float64), -1, 0)
    out = np.empty((*s.shape, 3, 3))
    out[..., 0, 0] = s * s + x * x - y * y - z * z
    out[..., 1, 1] = s * s - x * x + y * y - z * z
    out[..., 2, 2] = s * s - x * x - y * y + z * z
    for i, j, product, turn in ((0, 1, x * y, s * z), (2, 0, z * x, s * y), (1, 2, y * z, s * x)):
        out[..., i, j], out[..., j, i] = 2.0 * (product + turn), 2.0 * (product - turn)
    return out


def quaternion_of(matrix: Floats) -> Floats:
    """The unit quaternion (4,) with s >= 0 of one rotation matrix (3, 3), whichever component is largest."""
    c, trace = np.asarray(matrix, dtype=np.float64), float(np.trace(matrix))
    squares = np.array([1.0 + trace, *(1.0 - trace + 2.0 * np.diagonal(c))])
    largest = int(np.argmax(squares))
    twist = np.array([c[1, 2] - c[2, 1], c[2, 0] - c[0, 2], c[0, 1] - c[1, 0]])
    if largest == 0:
        found = np.array([squares[0], *twist])
    else:
        i = largest - 1
        found = np.concatenate([[twist[i]], c[i] + c[:, i]])
        found[1 + i] = squares[largest]
    out: Floats = found / np.linalg.norm(found)
    return out if out[0] >= 0.0 else -out


def product(first: Floats, then: Floats) -> Floats:
    """The quaternion (..., 4) of turning by ``first`` and then by ``then``: C(then) C(first)."""
    a, b = np.asarray(first), np.asarray(then)
    s, v = a[..., :1] * b[..., :1], np.cross(a[..., 1:], b[..., 1:])
    s = s - np.sum(a[..., 1:] * b[..., 1:], axis=-1, keepdims=True)
    return np.concatenate([s, a[..., :1] * b[..., 1:] + b[..., :1] * a[..., 1:] + v], axis=-1)


def conjugate(quaternions: Floats) -> Floats:
    """The inverse turn, (..., 4)."""
    out: Floats = np.asarray(quaternions) * np.array([1.0, -1.0, -1.0, -1.0])
    return out


def rotation_vector(quaternions: Floats) -> Floats:
    """Axis times angle (..., 3) of the shorter turn, rad; reference and body share the axis."""
    q = np.asarray(quaternions, dtype=np.float64)
    q = np.where(q[..., :1] < 0.0, -q, q)
    size = np.sqrt(np.square(q[..., 1:]).sum(axis=-1, keepdims=True))
    angle = 2.0 * np.arctan2(size, q[..., :1])
    out: Floats = q[..., 1:] * np.divide(angle, size, out=np.full_like(size, 2.0), where=size > 0.0)
    return out

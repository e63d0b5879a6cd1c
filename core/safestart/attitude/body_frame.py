"""The body frame of a target that spins about LVLH z, with the transport term (paper 000, eqs. 3 and 5).

theta = omega_t t is the angle by which the body frame is ahead of LVLH; the last axis of every array holds
(x, y) or (x, y, z), leading axes broadcast. Any other spin, and any attitude: :mod:`safestart.attitude.attitude`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safestart.model.scenario import Floats


def rotation(theta: float) -> Floats:
    """R_z(theta) in the plane, shape (2, 2): body coordinates to LVLH coordinates."""
    c, s = math.cos(theta), math.sin(theta)
    return np.array([[c, -s], [s, c]])


def into_body(cos: Any, sin: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """R_z(-theta) (x, y): LVLH coordinates to body coordinates; numbers or arrays that broadcast."""
    return cos * x + sin * y, cos * y - sin * x


def out_of_body(cos: Any, sin: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """R_z(theta) (x, y): body coordinates to LVLH coordinates; numbers or arrays that broadcast."""
    return cos * x - sin * y, sin * x + cos * y


def transport(position: Floats, tumble_rate: float) -> Floats:
    """omega x r for omega along z: the velocity of a body-fixed point seen from LVLH, in the same axes."""
    out = np.zeros_like(np.asarray(position, dtype=np.float64))
    out[..., 0] = -tumble_rate * position[..., 1]
    out[..., 1] = tumble_rate * position[..., 0]
    return out


def body_to_lvlh(
    position: Floats, velocity: Floats, tumble_rate: float, time: float | Floats
) -> tuple[Floats, Floats]:
    """Body-frame position (m) and velocity (m/s) to LVLH: v_L = R_z(theta) (v_B + omega x r_B) (eq. 5).

    ``time`` is one number, or one for each of the vectors.
    """
    turn = _cos_sin(tumble_rate, time)
    moving = velocity + transport(position, tumble_rate)
    return _turned(out_of_body, turn, position), _turned(out_of_body, turn, moving)


def lvlh_to_body(
    position: Floats, velocity: Floats, tumble_rate: float, time: float | Floats
) -> tuple[Floats, Floats]:
    """Inverse of :func:`body_to_lvlh`: p_B = R_z(-theta) p (eq. 3), v_B = R_z(-theta) v - omega x p_B."""
    turn = _cos_sin(tumble_rate, time)
    p = _turned(into_body, turn, position)
    return p, _turned(into_body, turn, velocity) - transport(p, tumble_rate)


def _cos_sin(tumble_rate: float, time: float | Floats) -> tuple[Any, Any]:
    theta = tumble_rate * np.asarray(time, dtype=np.float64)
    # Not NumPy's: its array cosines differ in the last bit between processors, and documents show these figures.
    cos = np.array([math.cos(angle) for angle in theta.ravel().tolist()])
    sin = np.array([math.sin(angle) for angle in theta.ravel().tolist()])
    return cos.reshape(theta.shape), sin.reshape(theta.shape)


def _turned(way: Any, turn: tuple[Any, Any], vectors: Floats) -> Floats:
    out = np.array(vectors, dtype=np.float64)
    x, y = way(*turn, np.array(out[..., 0]), np.array(out[..., 1]))
    if np.shape(x) != out.shape[:-1]:
        out = np.broadcast_to(out, (*np.shape(x), out.shape[-1])).copy()
    out[..., 0], out[..., 1] = x, y
    return out

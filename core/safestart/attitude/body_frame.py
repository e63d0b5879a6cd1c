"""Body-frame to LVLH transforms with the transport term (paper 000, eqs. 3 and 5).

theta = omega_t t is the angle by which the body frame is ahead of LVLH; the last axis of every array holds
(x, y) or (x, y, z), leading axes broadcast.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.model.scenario import Floats


def rotation(theta: float) -> Floats:
    """R_z(theta) in the plane, shape (2, 2): body coordinates to LVLH coordinates."""
    c, s = math.cos(theta), math.sin(theta)
    return np.array([[c, -s], [s, c]])


def _rotate(vectors: Floats, theta: float) -> Floats:
    c, s = math.cos(theta), math.sin(theta)
    out = np.array(vectors, dtype=np.float64)
    x, y = np.array(out[..., 0]), np.array(out[..., 1])
    out[..., 0] = c * x - s * y
    out[..., 1] = s * x + c * y
    return out


def transport(position: Floats, tumble_rate: float) -> Floats:
    """omega x r for omega along z: the velocity of a body-fixed point seen from LVLH, in the same axes."""
    out = np.zeros_like(np.asarray(position, dtype=np.float64))
    out[..., 0] = -tumble_rate * position[..., 1]
    out[..., 1] = tumble_rate * position[..., 0]
    return out


def body_to_lvlh(
    position: Floats, velocity: Floats, tumble_rate: float, time: float
) -> tuple[Floats, Floats]:
    """Body-frame position (m) and velocity (m/s) to LVLH: v_L = R_z(theta) (v_B + omega x r_B) (eq. 5)."""
    theta = tumble_rate * time
    return _rotate(position, theta), _rotate(velocity + transport(position, tumble_rate), theta)


def lvlh_to_body(
    position: Floats, velocity: Floats, tumble_rate: float, time: float
) -> tuple[Floats, Floats]:
    """Inverse of :func:`body_to_lvlh`: p_B = R_z(-theta) p (eq. 3), v_B = R_z(-theta) v - omega x p_B."""
    theta = tumble_rate * time
    p = _rotate(position, -theta)
    return p, _rotate(velocity, -theta) - transport(p, tumble_rate)

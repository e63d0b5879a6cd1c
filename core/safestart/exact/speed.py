"""The speed limit watched at all times, through v_max^2 - |v|^2, which is smooth like a face distance."""

from __future__ import annotations

import numpy as np

from safestart.exact.question import SPEED_SCALE
from safestart.model.scenario import Floats


def room(
    limit: float, mean_motion: float, step: float, flown: Floats, thrust: Floats
) -> tuple[Floats, Floats]:
    """v_max^2 - |v|^2 (N, S+1, 1) in m^2/s^2 and its slope times the sample's length ``step`` (s).

    ``flown`` (N, S+1, 2 d) are the states under ``thrust`` (N, d), in LVLH.
    """
    d, n = thrust.shape[-1], mean_motion
    v = flown[..., d:]
    rate = np.repeat(thrust[:, None, :], flown.shape[1], axis=1)
    rate[..., 0] += 3.0 * n * n * flown[..., 0] + 2.0 * n * v[..., 1]
    rate[..., 1] -= 2.0 * n * v[..., 0]
    if d == 3:
        rate[..., 2] -= n * n * flown[..., 2]
    left = limit * limit - np.square(v).sum(axis=-1, keepdims=True)
    return left, -2.0 * step * (v * rate).sum(axis=-1, keepdims=True)


def bend(mean_motion: float, bounds: tuple[float, float, float, float, float]) -> float:
    """Bound on the fourth derivative of |v|^2 (Leibniz), from bounds on |r| and its first four derivatives."""
    _, v, a, jerk, snap = bounds
    crackle = 3.0 * mean_motion**2 * jerk + 2.0 * mean_motion * snap
    return 2.0 * (v * crackle + 4.0 * a * snap + 3.0 * jerk * jerk)


def metres(limit: float, left: Floats) -> Floats:
    """Margin of the speed, S (v_max - |v|), from v_max^2 - |v|^2."""
    out: Floats = SPEED_SCALE * (limit - np.sqrt(np.maximum(limit * limit - left, 0.0)))
    return out

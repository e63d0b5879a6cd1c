"""The compiled twin of :func:`safestart.dynamics.burn.scattered`, for flights by the thousand."""

from __future__ import annotations

import math

import numpy as np

from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled


@compiled()
def scattered(burn: Floats, size_sigma: float, angle_sigma: float, drawn: Floats) -> Floats:
    """A ``burn`` (3,) with drawn errors, as :func:`safestart.dynamics.burn.scattered`."""
    out = burn.copy()
    size = math.sqrt(burn[0] ** 2 + burn[1] ** 2 + burn[2] ** 2)
    if size == 0.0:
        return out
    along, one, two = burn / size, np.zeros(3), np.empty(3)
    # Of the axes, the one that is furthest from the burn's direction: one = along x axis.
    k = 0
    for i in range(1, 3):
        if abs(along[i]) < abs(along[k]):
            k = i
    b, c = (k + 1) % 3, (k + 2) % 3
    one[b], one[c] = along[c], -along[b]
    one /= math.sqrt(one[b] ** 2 + one[c] ** 2)
    for i in range(3):
        b, c = (i + 1) % 3, (i + 2) % 3
        two[i] = along[b] * one[c] - along[c] * one[b]
    off = math.hypot(angle_sigma * drawn[1], angle_sigma * drawn[2])
    aside = math.sin(off) / off * angle_sigma if off > 0.0 else 0.0
    for i in range(3):
        turned = math.cos(off) * along[i] + aside * (drawn[1] * one[i] + drawn[2] * two[i])
        out[i] = size * (1.0 + size_sigma * drawn[0]) * turned
    return out

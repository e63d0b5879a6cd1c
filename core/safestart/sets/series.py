"""Drift and reachable displacement of a planar linear system as one spectral series.

Phi(t) and S(t, phi) = a_max * integral_0^t |Phi_rv(tau)^T e(phi)| dtau are smooth in time and pi-periodic in
direction: Chebyshev in time times Fourier in 2 phi converges geometrically. One approach of 40 s takes degree
8 and 3 harmonics to round-off, so a kernel can afford the exact set at any time and direction.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from safestart.model.scenario import Floats

CONVERGED = 1e-12
NEGLIGIBLE = 1e-14
MAX_DEGREE = 256
MAX_COUNT = 1024

DRIFT = 4
"""Columns before the support function: the drift matrix D, row-major."""


@dataclass(frozen=True, slots=True)
class ReachSeries:
    """Chebyshev coefficients on [0, horizon] of D(t) (4 columns), S_0(t), then a_k(t), b_k(t) for k = 1..K.

    D maps the start position to the position without thrust (both LVLH);
    S(t, phi) = S_0 + sum_k a_k cos(2 k phi) + b_k sin(2 k phi), metres. ``value`` (degree + 1, 5 + 2 K),
    ``slope`` the same of the time derivative. ``converged`` is False when the series ran out of terms.
    """

    horizon: float
    value: Floats
    slope: Floats
    converged: bool


def reach_series(
    motion: Callable[[float], Floats], start_velocity: Floats, horizon: float, a_max: float
) -> ReachSeries:
    """Series of the system whose planar transition matrix (4, 4) is ``motion(tau)``.

    ``start_velocity`` (2, 2) maps the start position to the start velocity (LVLH). Terms are doubled until the
    last three of either kind are below 1e-12 of the largest, and those below 1e-14 are dropped.
    """
    degree, count = 16, 32
    while True:
        drift, support = _interpolate(motion, start_velocity, horizon, a_max, degree, count)
        scale = np.abs(support).max()
        in_time, in_angle = np.abs(support[-3:]).max(), np.abs(support[:, -6:]).max()
        converged = bool(max(in_time, in_angle) <= CONVERGED * scale)
        if converged or degree >= MAX_DEGREE or count >= MAX_COUNT:
            break
        if in_time > CONVERGED * scale:
            degree *= 2
        if in_angle > CONVERGED * scale:
            count *= 2
    support = support[:, : 1 + 2 * _last(np.abs(support[:, 1:]).max(axis=0) / scale, 2)]
    rows = 1 + max(_last(np.abs(part).max(axis=1) / np.abs(part).max()) for part in (drift, support))
    value = np.ascontiguousarray(np.hstack([drift, support])[:rows])
    slope = np.zeros_like(value)
    if rows > 1:
        slope[:-1] = chebyshev.chebder(value, scl=2.0 / horizon)
    return ReachSeries(horizon, value, slope, converged)


def _last(sizes: Floats, group: int = 1) -> int:
    """Index of the last significant entry (number of groups, when entries come in groups)."""
    keep = np.flatnonzero(sizes > NEGLIGIBLE)
    if keep.size == 0:
        return 0
    return int(keep[-1]) if group == 1 else int(keep[-1]) // group + 1


def _interpolate(
    motion: Callable[[float], Floats],
    start_velocity: Floats,
    horizon: float,
    a_max: float,
    degree: int,
    count: int,
) -> tuple[Floats, Floats]:
    """Coefficients of D (degree + 2, 4) and of S (degree + 2, 1 + 2 K), K = count / 2 - 1."""
    k = np.arange(degree + 1)
    tau = 0.5 * horizon * (np.cos(np.pi * k / degree) + 1.0)
    phi = np.array([motion(float(t)) for t in tau])
    angle = np.pi * np.arange(count) / count
    pushed = np.swapaxes(phi[:, :2, 2:], 1, 2) @ np.stack([np.cos(angle), np.sin(angle)])
    rate = a_max * np.sqrt((pushed * pushed).sum(axis=1))
    drift = (phi[:, :2, :2] + phi[:, :2, 2:] @ start_velocity).reshape(-1, DRIFT)
    # Chebyshev coefficients from values at the extrema: a discrete cosine transform with halved ends.
    transform = (2.0 / degree) * np.cos(np.pi * np.outer(k, k) / degree)
    transform[:, [0, -1]] *= 0.5
    transform[[0, -1]] *= 0.5
    in_time = chebyshev.chebint(transform @ rate, lbnd=-1, scl=0.5 * horizon)
    waves = np.fft.rfft(in_time, axis=1) / count
    support = np.empty((degree + 2, count - 1))
    support[:, 0] = waves[:, 0].real
    support[:, 1::2] = 2.0 * waves[:, 1:-1].real
    support[:, 2::2] = -2.0 * waves[:, 1:-1].imag
    return np.vstack([transform @ drift, np.zeros((1, DRIFT))]), support

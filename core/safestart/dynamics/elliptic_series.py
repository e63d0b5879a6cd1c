"""Taylor series in time of the relative motion on an elliptic orbit, for intervals in which LVLH turns little.

With c = cos nu, s = sin nu and rho = 1 + e c: c' = -w s, s' = w c, w = k^2 rho^2, g = mu / r^3 = k^4 rho^3. Each
coefficient is a polynomial of the earlier ones; those of the states follow from the equations in
:mod:`safestart.dynamics.yamanaka_ankersen`.
"""

from __future__ import annotations

import numpy as np

from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import Floats

LARGEST_TURN = 0.1
"""Largest turn of LVLH, rad; the series converge up to about 1.4 at e = 0.8, so the rest is below 1e-16."""
_ORDER = 14


def series(orbit: KeplerOrbit, begin: Floats, tau: Floats) -> tuple[Floats, Floats]:
    """Phi (J, 6, 6) and the effect of held thrust (J, 6, 3), from ``begin`` (J,) over ``tau`` (J,), s."""
    rate, change, tide = _orbit(orbit, begin)
    count = len(begin)
    # Columns: the six unit states, then the three unit thrusts from rest at 0.
    r = np.zeros((_ORDER + 1, count, 3, 9))
    r[0, :, :, :3] = np.eye(3)
    r[1, :, :, 3:6] = np.eye(3)
    square = np.array([_product(rate, rate, k) for k in range(_ORDER)])
    for k in range(_ORDER - 1):
        past = r[: k + 1][::-1]
        speed = np.arange(1, k + 2)[:, None, None, None] * r[1 : k + 2]
        speed = speed[::-1]
        w, dw, ww, g = (e[: k + 1, :, None] for e in (rate, change, square, tide))
        force = np.empty((count, 3, 9))
        x, y, z = past[:, :, 0], past[:, :, 1], past[:, :, 2]
        force[:, 0] = (2.0 * w * speed[:, :, 1] + dw * y + (ww + 2.0 * g) * x).sum(axis=0)
        force[:, 1] = (-2.0 * w * speed[:, :, 0] - dw * x + (ww - g) * y).sum(axis=0)
        force[:, 2] = (-g * z).sum(axis=0)
        if k == 0:
            force[:, :, 6:] += np.eye(3)
        r[k + 2] = force / ((k + 1) * (k + 2))
    step = tau[:, None, None]
    position, velocity = r[_ORDER].copy(), _ORDER * r[_ORDER]
    for k in range(_ORDER - 1, -1, -1):
        position = position * step + r[k]
        if k:
            velocity = velocity * step + k * r[k]
    both = np.concatenate([position, velocity], axis=1)
    return both[..., :6], both[..., 6:]


def _orbit(orbit: KeplerOrbit, begin: Floats) -> tuple[Floats, Floats, Floats]:
    """Coefficients (order, J) of w, w' and g."""
    e = orbit.eccentricity
    pace = orbit.mean_motion / (1.0 - e * e) ** 1.5
    nu = orbit.true_anomaly + orbit.turned(begin)
    cos, sin = np.zeros((_ORDER + 1, len(nu))), np.zeros((_ORDER + 1, len(nu)))
    rho, rho2, rate, tide = (np.zeros((_ORDER + 1, len(nu))) for _ in range(4))
    cos[0], sin[0] = np.cos(nu), np.sin(nu)
    for k in range(_ORDER + 1):
        rho[k] = e * cos[k] + (1.0 if k == 0 else 0.0)
        rho2[k] = _product(rho, rho, k)
        rate[k] = pace * rho2[k]
        tide[k] = pace * pace * _product(rho2, rho, k)
        if k < _ORDER:
            cos[k + 1] = -_product(rate, sin, k) / (k + 1)
            sin[k + 1] = _product(rate, cos, k) / (k + 1)
    return rate, np.arange(1, _ORDER + 1)[:, None] * rate[1:], tide


def _product(a: Floats, b: Floats, k: int) -> Floats:
    """Coefficient k of a product."""
    out: Floats = (a[: k + 1] * b[: k + 1][::-1]).sum(axis=0)
    return out

"""Support function of the displacement reachable under a disk input, by quadrature in time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from safestart.model.scenario import Floats


def disk_support(
    motion: Callable[[float], Floats], time: float, a_max: float, angles: Floats, nodes: int = 32
) -> Floats:
    """S(t, phi) = a_max * integral over [0, t] of |Phi_rv(tau)^T e(phi)| dtau, metres.

    ``motion(tau)`` is the planar transition matrix (4, 4), ``angles`` (...) the polar angles phi (rad) of e in
    LVLH, ``nodes`` the number of Gauss-Legendre points. The displacement that attains it flies the thrust
    a_max Phi_rv(t - s)^T e / |Phi_rv(t - s)^T e| at time s. The reference for
    :func:`safestart.sets.series.reach_series`, which is made for many times and directions.
    """
    x, weight = np.polynomial.legendre.leggauss(nodes)
    tau = 0.5 * time * (x + 1.0)
    unit = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    total = np.zeros(np.shape(angles))
    for one, w in zip(tau, weight, strict=True):
        pushed = unit @ motion(float(one))[:2, 2:]
        total += w * np.sqrt((pushed * pushed).sum(axis=-1))
    return np.asarray(0.5 * time * a_max * total)

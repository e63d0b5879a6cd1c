"""Inertia tensors: which are those of a rigid body, their principal axes, and when a spin changes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from safestart.errors import invalid
from safestart.model.scenario import Floats

_TRIANGLE = 1e-9


def principal_axes(inertia: Floats) -> tuple[Floats, Floats]:
    """Principal moments, rising, and the rows (3, 3), right-handed, that lead from body axes to principal axes."""
    if not (inertia - np.diag(np.diagonal(inertia))).any():
        # Exact test, so that a spin about an axis of the body is one about a principal axis.
        order = np.argsort(np.diagonal(inertia), kind="stable")
        moments, rows = np.diagonal(inertia)[order], np.eye(3)[order]
    else:
        moments, columns = np.linalg.eigh(inertia)
        rows = columns.T.copy()
    if np.linalg.det(rows) < 0.0:
        rows[2] *= -1.0
    return moments, rows


def checked_inertia(value: Sequence[Sequence[float]]) -> Floats:
    """The inertia (3, 3); raises ``InvalidInput`` unless it is one of a rigid body."""
    try:
        inertia = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise invalid("inertia", "three rows of three numbers, kg m^2", value) from None
    if inertia.shape != (3, 3) or not np.isfinite(inertia).all():
        raise invalid("inertia", "three rows of three finite numbers, kg m^2", value)
    if (inertia != inertia.T).any():
        raise invalid("inertia", "a symmetric tensor", inertia.tolist())
    moments = np.linalg.eigvalsh(inertia)
    size = float(moments[2])
    if not 1e-6 <= size <= 1e12:
        raise invalid("inertia", "a largest principal moment in [1e-6, 1e12] kg m^2", moments.tolist())
    if not (moments[0] > 1e-9 * size and moments[0] + moments[1] >= (1.0 - _TRIANGLE) * size):
        required = "positive principal moments, none above the sum of the other two"
        raise invalid("inertia", required, moments.tolist())
    return inertia


def turns(moments: Floats, spin: Floats) -> bool:
    """Whether the angular velocity changes, by Euler's equations: exactly never between two equal moments.

    The cross product of spin and momentum would round to something else. Below 1e-140 rad/s^2 nothing changes in any
    time, and squares underflow.
    """
    (a, b, c), (wa, wb, wc) = moments.tolist(), spin.tolist()
    changes = ((c - b) / a * wb * wc, (a - c) / b * wc * wa, (b - a) / c * wa * wb)
    return any(abs(change) > 1e-140 for change in changes)

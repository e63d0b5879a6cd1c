"""Starts in the forms that users write, and a scenario in its wire form."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from safestart.errors import invalid
from safestart.model.float_array import float_array
from safestart.model.scenario import MAX_RANGE, Floats, Rest, Scenario

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def points_of(points: ArrayLike) -> Floats:
    """Body-frame points (..., 2) or (..., 3) in metres; raises ``InvalidInput`` for anything else."""
    try:
        found = float_array(points)
    except (TypeError, ValueError, OverflowError):
        raise invalid("points", "numbers, last axis of length 2 or 3 (metres)", points) from None
    if found.ndim == 0 or found.shape[-1] not in (2, 3):
        raise invalid("points", "last axis of length 2 or 3 (metres)", found.shape)
    if not (np.abs(found) <= MAX_RANGE).all():
        raise invalid("points", f"finite coordinates within {MAX_RANGE:g} m", "NaN or more")
    return found


def point_of(start: ArrayLike) -> Floats:
    """One body-frame point (2,) or (3,) in metres; raises ``InvalidInput`` for anything else."""
    found = points_of(start)
    if found.ndim != 1:
        raise invalid("start", "shape (2,) or (3,): x, y and perhaps z in metres", found.shape)
    return found


def rest_of(rest: Rest | str) -> Rest:
    """The frame in which a start is at rest; raises ``InvalidInput`` for anything else."""
    try:
        return Rest(rest)
    except ValueError:
        raise invalid("rest", " or ".join(Rest), rest) from None


def seconds(name: str, value: float) -> float:
    """A horizon in its wire form; raises ``InvalidInput`` unless it is a multiple of 2 s up to 600 s."""
    required = "a multiple of 2 s in [2, 600]"
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        raise invalid(name, required, value)
    if not 2.0 <= value <= 600.0 or value % 2.0 != 0.0:
        raise invalid(name, required, value)
    return float(value)


def wire_of(scenario: Scenario) -> dict[str, Any]:
    """The scenario's fields on the wire."""
    shape = scenario.corridor
    return {
        "omega_t_deg_s": degrees_of(scenario.target.tumble_rate),
        "a_max_m_s2": scenario.chaser.max_acceleration,
        "mean_motion_rad_s": scenario.target.mean_motion,
        "corridor": {
            "c_x": shape.c_x,
            "c_z": shape.c_z,
            "x0_m": shape.x0,
            "z0_m": shape.z0,
            "r_h_m": shape.hold_radius,
        },
    }


def state_of(point: Floats) -> dict[str, float]:
    """A start's fields on the wire."""
    return dict(zip(("x_m", "y_m", "z_m"), point.tolist(), strict=False))


def degrees_of(rate: float) -> float:
    """Degrees whose radians equal ``rate`` exactly if such exist; otherwise the nearest, off by one rounding."""
    nearest = math.degrees(rate)
    tried = [round(nearest, 12), nearest]
    for end in (0.0, math.inf):
        step = nearest
        for _ in range(4):
            step = math.nextafter(step, end)
            tried.append(step)
    return next((value for value in tried if math.radians(value) == rate), nearest)

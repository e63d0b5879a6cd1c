"""The frozen inputs of every question, in SI units: target, chaser, corridor, grid.

Frames: LVLH has x radial, y along-track, z cross-track. The target's body frame coincides with LVLH at t = 0
and rotates about z at the tumble rate (paper 000, eq. 3). The line-of-sight corridor is fixed in the body
frame and opens along +y.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from safestart.errors import invalid

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

# No mission exceeds these bounds; a value beyond them has the wrong unit (degrees for radians, mm for m).
MAX_TUMBLE_DEG_S = 60.0
MAX_TUMBLE_RATE = math.radians(MAX_TUMBLE_DEG_S)
# An ion engine on a tonne gives about 1e-5; below 1e-6 m/s^2 nothing can be arrested.
MIN_ACCELERATION, MAX_ACCELERATION = 1e-6, 10.0
MAX_MEAN_MOTION = 1.3e-3
MAX_RANGE = 10_000.0
MAX_CELLS = 1_000_000


class Rest(StrEnum):
    """The frame in which a start is at rest (Iskender et al. leave it open; the two sets differ strongly)."""

    LVLH = "lvlh"
    BODY = "body"


class SetKind(StrEnum):
    """Reach the corridor at some time up to the horizon (tube), or at the horizon itself (fixed)."""

    TUBE = "tube"
    FIXED = "fixed"


def number(name: str, value: Any, low: float, high: float, *, open_low: bool = False) -> float:
    """Return ``value`` as a float inside [low, high] (or (low, high]); raise ``InvalidInput`` otherwise."""
    left = "(" if open_low else "["
    required = f"a finite number in {left}{low:g}, {high:g}]"
    if isinstance(value, bool) or not isinstance(value, int | float | np.floating | np.integer):
        raise invalid(name, required, value)
    result = float(value)
    if not math.isfinite(result) or result > high or result < low or (open_low and result == low):
        raise invalid(name, required, value)
    return result


@dataclass(frozen=True, slots=True)
class Target:
    """The tumbling target: tumble rate about LVLH z (rad/s) and mean motion of its orbit (rad/s)."""

    tumble_rate: float
    mean_motion: float = 1.1e-3

    def __post_init__(self) -> None:
        number("tumble_rate", self.tumble_rate, 0.0, MAX_TUMBLE_RATE)
        number("mean_motion", self.mean_motion, 0.0, MAX_MEAN_MOTION)


@dataclass(frozen=True, slots=True)
class Chaser:
    """The chaser: maximum thrust acceleration (m/s^2), a Euclidean disk (ball in 3-D)."""

    max_acceleration: float

    def __post_init__(self) -> None:
        number("max_acceleration", self.max_acceleration, MIN_ACCELERATION, MAX_ACCELERATION)


@dataclass(frozen=True, slots=True)
class CorridorShape:
    """Parameters of the five-face corridor (paper 000, eq. 4): slopes, port half-widths (m), hold radius (m)."""

    c_x: float = 1.5
    c_z: float = 1.5
    x0: float = 2.5
    z0: float = 2.5
    hold_radius: float = 0.5

    def __post_init__(self) -> None:
        number("c_x", self.c_x, 0.0, 100.0, open_low=True)
        number("c_z", self.c_z, 0.0, 100.0, open_low=True)
        number("x0", self.x0, 0.0, 1000.0)
        number("z0", self.z0, 0.0, 1000.0)
        number("hold_radius", self.hold_radius, 0.0, 1000.0)


@dataclass(frozen=True, slots=True)
class Scenario:
    """Target, chaser and corridor: everything the safe-start question depends on except the start."""

    target: Target
    chaser: Chaser
    corridor: CorridorShape = field(default_factory=CorridorShape)

    @classmethod
    def of(cls, omega_t_deg_s: float, a_max: float, mean_motion: float = 1.1e-3) -> Scenario:
        """Scenario with the paper's corridor from a tumble rate in deg/s and a thrust in m/s^2."""
        degrees = number("omega_t_deg_s", omega_t_deg_s, 0.0, MAX_TUMBLE_DEG_S)
        return cls(Target(math.radians(degrees), mean_motion), Chaser(a_max))

    @property
    def sync_radius(self) -> float:
        """Synchronization range bound r_sync = 2 a_max / omega_t^2 in metres (eq. 9); inf when not tumbling."""
        squared = self.target.tumble_rate**2
        return 2.0 * self.chaser.max_acceleration / squared if squared > 0.0 else math.inf


@dataclass(frozen=True, slots=True)
class Grid:
    """Planar body-frame grid over the corridor cut at ``y_max``.

    x runs over +-(x0 + c_x (y_max - r_h)), y over [0, y_max]; masks are row-major ``[iy][ix]``.
    """

    nx: int = 31
    ny: int = 31
    y_max: float = 150.0

    def __post_init__(self) -> None:
        for name in ("nx", "ny"):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or not 2 <= value <= 4001:
                raise invalid(name, "an integer in [2, 4001]", value)
        if self.nx * self.ny > MAX_CELLS:
            raise invalid("grid", f"nx * ny at most {MAX_CELLS}", self.nx * self.ny)
        number("y_max", self.y_max, 0.0, MAX_RANGE, open_low=True)

    def axes(self, shape: CorridorShape) -> tuple[Floats, Floats]:
        """x (nx,) and y (ny,) coordinates in metres."""
        if self.y_max <= shape.hold_radius:
            raise invalid("y_max", f"more than the hold radius {shape.hold_radius:g} m", self.y_max)
        half = shape.x0 + shape.c_x * (self.y_max - shape.hold_radius)
        return np.linspace(-half, half, self.nx), np.linspace(0.0, self.y_max, self.ny)

    def points(self, shape: CorridorShape) -> Floats:
        """Cell points, shape (ny, nx, 2), last axis (x_B, y_B) in metres."""
        x, y = self.axes(shape)
        out = np.empty((self.ny, self.nx, 2))
        out[..., 0] = x[None, :]
        out[..., 1] = y[:, None]
        return out

    def cell_area(self, shape: CorridorShape) -> float:
        """Area in m^2 that one grid point stands for."""
        x, y = self.axes(shape)
        return float((x[1] - x[0]) * (y[1] - y[0]))

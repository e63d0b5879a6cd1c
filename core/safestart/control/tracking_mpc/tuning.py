"""The settings of a tracking MPC: corridor, limits, horizons and weights."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import cache
from typing import Literal, get_args

import numpy as np
from scipy.spatial import ConvexHull

from safestart.constraints.corridor import Corridor, polyhedron
from safestart.errors import invalid
from safestart.model.scenario import Floats, number

FIXED_TOLERANCE = 1e-9
"""Allowed violation (m) of corridor rows that no input affects: a start's own, and those of the next step."""
ThetaLimit = Literal["printed", "ball", "corners", "polytope", "zero"]
InputLimit = Literal["box", "ball"]
MAX_HORIZON = 400
LEAST_U_MAX = 1e-9
"""Smallest u_max, m/s: below it rows of theta and of the corridor differ by more than doubles tell apart."""


@dataclass(frozen=True, slots=True)
class DockingCorridor:
    """The prism of paper 002, eq. (4): y >= 0, |x| <= x0 + y / c_x, |z| <= z0 + y / c_z in the body frame, m.

    ``y0``, m: it begins there (y - y0 stands for y), for a port away from the target's centre. Raises ``InvalidInput``
    for a slope that is not positive and a length below 0.
    """

    c_x: float = 1.0
    c_z: float = 1.0
    x0: float = 0.1
    z0: float = 0.1
    y0: float = 0.0

    def __post_init__(self) -> None:
        number("c_x", self.c_x, 0.0, 1e3, open_low=True)
        number("c_z", self.c_z, 0.0, 1e3, open_low=True)
        number("x0", self.x0, 0.0, 1e3)
        number("z0", self.z0, 0.0, 1e3)
        number("y0", self.y0, 0.0, 1e3)

    def faces(self) -> Corridor:
        """The five half-spaces with unit normals, so that a slack is a distance in metres."""
        normals = np.array(
            [
                [0.0, -1.0, 0.0],
                [self.c_x, -1.0, 0.0],
                [-self.c_x, -1.0, 0.0],
                [0.0, -1.0, self.c_z],
                [0.0, -1.0, -self.c_z],
            ]
        )
        side_x, side_z = self.c_x * self.x0 - self.y0, self.c_z * self.z0 - self.y0
        offsets = np.array([-self.y0 + 0.0, side_x, side_x, side_z, side_z])
        lengths = np.sqrt((normals**2).sum(axis=1))
        names = ("port_plane", "right", "left", "top", "bottom")
        return polyhedron(normals / lengths[:, None], offsets / lengths, names)


@dataclass(frozen=True, slots=True)
class Tuning:
    """Limits, horizons and weights.

    ``u_max`` m/s per step: ``box`` per body axis, ``ball`` in length. ``n_c`` free inputs, then ``n_lqr`` steps of the
    regulator and two of dead-beat. The cost is sum |x - x_e|^2 + ``rho`` |u - u_e|^2 + ``tau`` |theta|^2, and ``rho``
    weighs the regulator's too. Raises ``InvalidInput`` for values out of range and for ``n_c`` > ``n_lqr``.
    """

    u_max: float = 0.075
    n_c: int = 3
    n_lqr: int = 30
    rho: float = 100.0
    tau: float = 100.0
    theta_limit: ThetaLimit = "polytope"
    input_limit: InputLimit = "box"

    def __post_init__(self) -> None:
        number("u_max", self.u_max, LEAST_U_MAX, 100.0)
        number("rho", self.rho, 0.0, 1e9, open_low=True)
        number("tau", self.tau, 0.0, 1e9)
        for name in ("n_c", "n_lqr"):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= MAX_HORIZON:
                raise invalid(name, f"a whole number from 1 to {MAX_HORIZON}", value)
        if self.n_c > self.n_lqr:
            raise invalid("n_c", f"at most n_lqr, {self.n_lqr}", self.n_c)
        if self.theta_limit not in get_args(ThetaLimit):
            raise invalid("theta_limit", f"one of {', '.join(get_args(ThetaLimit))}", self.theta_limit)
        if self.input_limit not in get_args(InputLimit):
            raise invalid("input_limit", f"one of {', '.join(get_args(InputLimit))}", self.input_limit)

    @property
    def sides(self) -> tuple[Floats, float]:
        """Unit normals (S, 3) and a bound: |sides u| <= bound for the box, or for a polyhedron inside the ball."""
        return input_sides(self.input_limit, self.u_max)

    @property
    def inputs(self) -> int:
        """N_p: number of inputs of a plan before it stays on its equilibrium, N_c + N + 2."""
        return self.n_c + self.n_lqr + 2


def input_sides(limit: InputLimit, u_max: float) -> tuple[Floats, float]:
    """Unit normals (S, 3) and a bound: |sides u| <= bound describes the box, or a polyhedron inside the ball."""
    if limit == "box":
        return np.eye(3), u_max
    normals, reach = _round_body()
    return normals, u_max / reach


@cache
def _round_body() -> tuple[Floats, float]:
    """The 31 axes (31, 3) of an icosahedron, and the farthest point of the body of 62 faces |axis . u| <= 1."""
    golden = 0.5 * (1.0 + math.sqrt(5.0))
    corner = np.array([[0.0, 1.0, golden], [0.0, -1.0, golden]])
    corners = np.vstack([np.roll(corner, shift, axis=1) for shift in range(3)])
    corners = np.vstack([corners, -corners])
    axes = [corners]
    for count in (2, 3):
        sums = [
            corners[list(chosen)].sum(axis=0)
            for chosen in itertools.combinations(range(12), count)
            if all(
                np.isclose(np.linalg.norm(corners[i] - corners[j]), 2.0)
                for i, j in itertools.combinations(chosen, 2)
            )
        ]
        axes.append(np.array(sums))
    every = np.vstack(axes)
    every /= np.linalg.norm(every, axis=1, keepdims=True)
    half = every[np.lexsort(np.round(every, 9).T)]
    kept: list[Floats] = []
    for axis in half:
        if all(abs(abs(float(axis @ other)) - 1.0) > 1e-9 for other in kept):
            kept.append(axis)
    normals = np.array(kept)
    hull = ConvexHull(np.vstack([normals, -normals]))
    # A corner of the body stands for every facet of the hull of its normals.
    reach = float((np.linalg.norm(hull.equations[:, :3], axis=1) / -hull.equations[:, 3]).max())
    return np.ascontiguousarray(normals), reach * (1.0 + 1e-12)

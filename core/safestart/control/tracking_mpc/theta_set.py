"""The polyhedra that the artificial reference theta may lie in, as rows on theta alone (body axes).

Every one holds the corridor's faces. ``printed`` adds y <= y_max of paper 002 (42)-(45); ``ball`` the largest such cut
inside the rigorous ball; ``corners`` the largest whose corners need at most u_max at every node of the window;
``polytope`` the input's own rows on u_e(k; theta), without those that others imply; ``zero`` theta = 0. A window is the
nodes of a flight and of its last plan, so that a theta allowed at one node is allowed at the next. With held thrust the
chaser passes a little beside theta, by a share of |theta|: the corridor's faces lean in by so much at every height y.
Moved in by the most for all, far thetas would keep near ones from the port.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull

from safestart.control.tracking_mpc.equilibrium import inputs, places
from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.theta_radius import ball_radius, printed_radius
from safestart.control.tracking_mpc.tumble import Tumble
from safestart.control.tracking_mpc.tuning import DockingCorridor, Tuning
from safestart.errors import invalid
from safestart.model.scenario import Floats

_FARTHEST = 1e5
"""Stands for no cut, m: at a target at rest the chaser needs no input to stay anywhere."""


@dataclass(frozen=True)
class ThetaSet:
    """``normals`` (H, 3) @ theta in [``low``, ``high``] (H,), m or m/s; ``y_max`` of a cut, m, else None."""

    normals: Floats
    low: Floats
    high: Floats
    y_max: float | None = None

    def contains(self, theta: Floats, tolerance: float = 1e-9) -> bool:
        """Whether ``theta`` (3,) fulfils all rows."""
        values = self.normals @ theta
        return bool((values <= self.high + tolerance).all() and (values >= self.low - tolerance).all())


def theta_set(
    tuning: Tuning, shape: DockingCorridor, tumble: Tumble | None, motion: Sampled, attitudes: Floats
) -> ThetaSet:
    """The set of a tuning's limit for a window of ``attitudes`` (K, 3, 3).

    Raises ``InvalidInput`` for ``printed`` with held thrust, for ``printed`` and ``ball`` without a ``tumble``, and for
    ``zero`` where the corridor begins away from the target's centre.
    """
    limit = tuning.theta_limit
    sides, most = tuning.sides
    if limit == "zero":
        if shape.y0 > 0.0:
            raise invalid("theta_limit", "another limit: the target's centre is behind the hold plane", limit)
        return ThetaSet(np.eye(3), np.zeros(3), np.zeros(3))
    if limit == "polytope":
        return _polytope(shape, sides @ inputs(motion, attitudes), most, _beside(motion, attitudes))
    if limit == "corners":
        y_max = corner_cut(shape, sides @ inputs(motion, attitudes), most)
    elif tumble is None:
        raise invalid("theta_limit", "corners, polytope or zero for a target that is not torque-free", limit)
    elif limit == "printed":
        if motion.held:
            raise invalid("theta_limit", "another limit: paper 002's formula is about impulses", limit)
        y_max = printed_cut(shape, printed_radius(tumble, motion, tuning.u_max))
    else:
        y_max = cut_inside(shape, ball_radius(tumble, motion, most))
    faces = shape.faces()
    normals = np.vstack([faces.normals, [0.0, 1.0, 0.0]])
    high = np.append(faces.offsets, max(y_max, shape.y0))
    _lean_in(shape, normals, high, _beside(motion, attitudes))
    return ThetaSet(normals, np.full(len(high), -np.inf), high, y_max)


def _beside(motion: Sampled, attitudes: Floats) -> float:
    """How far a chaser that stays at theta is beside it at most, in m per m of |theta|."""
    if not motion.held:
        return 0.0
    return float(np.linalg.norm(places(motion, attitudes) - np.eye(3), 2, axis=(1, 2)).max())


def _lean_in(shape: DockingCorridor, normals: Floats, high: Floats, beside: float) -> None:
    """Change the corridor's rows, the first five of ``normals`` and ``high``, so that ``beside`` |theta| is left over.

    In the corridor |theta| <= |(x0 - y0 / c_x, 0, z0 - y0 / c_z)| + y |(1 / c_x, 1, 1 / c_z)|, which is affine in y.
    """
    if beside > 0.0:
        x0, z0 = shape.x0 - shape.y0 / shape.c_x, shape.z0 - shape.y0 / shape.c_z
        normals[:5, 1] += beside * math.hypot(1.0 / shape.c_x, 1.0, 1.0 / shape.c_z)
        high[:5] -= beside * math.hypot(x0, z0)


def printed_cut(shape: DockingCorridor, radius: float) -> float:
    """y_max of (42)-(45) as printed, with the sign error of xi_1; not positive where the ball is too small for it."""
    cx, cz = shape.c_x, shape.c_z
    x0, z0 = shape.x0 - shape.y0 / cx, shape.z0 - shape.y0 / cz
    if math.isinf(radius):
        return _FARTHEST
    first = (cx * cz) ** 2 * (x0 * x0 + z0 * z0) + (cz * z0 + cx * x0) ** 2
    second, third = cx * z0 + cz * x0, (cx * cz) ** 2 + cx * cx + cz * cz
    return cx * cz * (math.sqrt(max(third * radius * radius - first, 0.0)) - second) / third


def cut_inside(shape: DockingCorridor, radius: float) -> float:
    """Largest y whose corners (+-(x0 + y / c_x), y, +-(z0 + y / c_z)) are inside the ball; below 0: none."""
    if math.isinf(radius):
        return _FARTHEST
    a = 1.0 + 1.0 / shape.c_x**2 + 1.0 / shape.c_z**2
    x0, z0 = shape.x0 - shape.y0 / shape.c_x, shape.z0 - shape.y0 / shape.c_z
    b = x0 / shape.c_x + z0 / shape.c_z
    c = x0**2 + z0**2 - radius * radius
    return (math.sqrt(b * b - a * c) - b) / a if c <= 0.0 else -1.0


def corner_cut(shape: DockingCorridor, maps: Floats, u_max: float) -> float:
    """Largest y whose four corners keep |maps theta| <= u_max for all of ``maps`` (K, S, 3); below 0: none."""
    y_max = _FARTHEST
    for side_x in (-1.0, 1.0):
        for side_z in (-1.0, 1.0):
            x0, z0 = shape.x0 - shape.y0 / shape.c_x, shape.z0 - shape.y0 / shape.c_z
            at_port = maps @ np.array([side_x * x0, 0.0, side_z * z0])
            along = maps @ np.array([side_x / shape.c_x, 1.0, side_z / shape.c_z])
            for sign in (1.0, -1.0):
                rest, growth = u_max - sign * at_port, sign * along
                if (rest < 0.0).any():
                    return -1.0
                growing = growth > 0.0
                y_max = min(y_max, float(np.min(rest[growing] / growth[growing], initial=np.inf)))
    return y_max


def _polytope(shape: DockingCorridor, maps: Floats, u_max: float, beside: float) -> ThetaSet:
    """Corridor and |maps theta| <= u_max for ``maps`` (K, S, 3), without the rows that the others imply."""
    faces = shape.faces()
    rows = maps.reshape(-1, 3)
    normals = np.vstack([faces.normals, rows, -rows, [[0.0, 1.0, 0.0]]])
    high = np.concatenate([faces.offsets, np.full(2 * len(rows), u_max), [_FARTHEST]])
    # Seen from a point inside, the necessary rows are the corners of the hull of normal / distance.
    reach = float(np.abs(rows @ [0.0, 1.0, 0.0]).max(initial=0.0))
    height = u_max / max(reach, u_max / _FARTHEST)
    if height <= shape.y0:
        # The input cannot hold the middle of the port: no theta, by two rows that contradict each other.
        normals = np.vstack([faces.normals, [0.0, 1.0, 0.0]])
        high = np.append(faces.offsets, shape.y0 - 1.0)
        return ThetaSet(normals, np.full(len(high), -np.inf), high)
    inside = np.array([0.0, shape.y0 + 0.5 * min(height - shape.y0, 1.0), 0.0])
    room = high - normals @ inside
    hull = ConvexHull(normals / room[:, None])
    # The corridor's own faces are identified by their order, so they stay.
    kept = np.union1d(np.arange(len(faces.offsets)), np.sort(hull.vertices))
    # What the faces imply, they imply all the more when they lean in.
    _lean_in(shape, normals, high, beside)
    return ThetaSet(normals[kept], np.full(len(kept), -np.inf), high[kept])

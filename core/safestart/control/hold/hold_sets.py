"""Which errors the LQR corrects without leaving the corridor or the thrust limit: an ellipsoid and a polyhedron.

The error e = x - x_ref (LVLH, 4) obeys e(k+1) = F e(k), and tau after a node it is M(tau) e, M = Phi - B K. A unit face
n of the body asks n . R p <= b at all times, the thrust |u_ref - K e| <= a_max.

**Ellipsoid** {e' P e <= rho}, invariant as F' P F <= P; for every angle of the body. At tau the reference keeps
room(tau) of each face, and the error takes at most sqrt(rho lambda_max(M_p P^-1 M_p')) of it, whatever way the face
points; so does -K e of the thrust.

**Polyhedron**: all e whose whole flight, from one angle of the body at the start, stays admissible. Each node and each
instant between gives rows in e. Once all vertices are inside the ellipsoid after K + 1 steps, later rows hold by
themselves, and rows 0 .. K are all there are.

Between watched instants, h apart, a distance falls by at most h^2 / 8 times the bound on its second derivative below
its chord; each row gives that much away. The bound needs the size of the set itself: it is assumed, and checked with
the set that it gave. The thrust's disk is replaced by an inner polygon.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from safestart.attitude.body_frame import rotation
from safestart.constraints.corridor import Corridor
from safestart.control.hold.hold_lqr import Design
from safestart.control.hold.turning_reference import TurningReference
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.model.scenario import Floats

WATCHED = 8
"""Instants watched in each step."""
SIDES = 48
"""Sides of the polygon inside the thrust disk."""
_LONGEST = 512
_ATTEMPTS = 8


@dataclass(frozen=True, slots=True)
class Hold:
    """One loop and its limits; ``corridor`` planar, ``most`` the thrust limit, m/s^2."""

    design: Design
    reference: TurningReference
    corridor: Corridor
    most: float

    @property
    def usable(self) -> float:
        """Thrust that the inner polygon of the disk holds in every direction, m/s^2."""
        return self.most * math.cos(math.pi / SIDES)

    def instants(self) -> Floats:
        """Watched times after a node, s, (WATCHED,)."""
        return self.reference.step * np.arange(WATCHED) / WATCHED

    def moved(self, tau: float) -> Floats:
        """Position rows (2, 4) of M(tau)."""
        n = self.reference.mean_motion
        return np.asarray((planar_transition(n, tau) - planar_input(n, tau) @ self.design.gain)[:2])

    def sag(self, position: float, velocity: float) -> float:
        """How far a distance can fall below its chord, m, while errors at nodes are at most m and m/s in size."""
        n, rate, step = self.reference.mean_motion, self.reference.rate, self.reference.step
        p = position + float(np.abs(self.reference.state[:2]).max()) * math.sqrt(2.0)
        v = velocity + float(np.linalg.norm(self.reference.state[2:]))
        # In a step the speed grows by a few times the largest acceleration's share; 1.5 covers e^(n step) < 1.1.
        v += 1.5 * step * (self.most + 3.0 * n * n * p + 2.0 * n * v)
        p += 1.5 * step * v
        bend = self.most + 3.0 * n * n * p + 2.0 * n * v + 2.0 * rate * v + rate * rate * p
        return (step / WATCHED) ** 2 / 8.0 * bend


@dataclass(frozen=True, slots=True)
class Ellipsoid:
    """{e' P e <= ``level``}; ``limited_by`` names a face or the thrust; level 0: the hold itself is not possible."""

    level: float
    limited_by: str
    volume: float
    extents: Floats


@dataclass(frozen=True, slots=True)
class Polyhedron:
    """{``rows`` @ e <= ``bounds``}, irredundant; ``vertices`` (V, 4); ``steps`` K; volume in m^4/s^2."""

    rows: Floats
    bounds: Floats
    vertices: Floats
    steps: int
    volume: float


def ellipsoid(hold: Hold) -> Ellipsoid:
    """The largest one, at every angle of the body."""
    inverse = np.linalg.inv(hold.design.cost)
    normals = hold.corridor.normals / hold.corridor.lengths[:, None]
    offsets = hold.corridor.offsets / hold.corridor.lengths
    spread = hold.design.gain @ inverse @ hold.design.gain.T
    spare = hold.usable - hold.reference.most_thrust
    limits = [("thrust", spare, float(np.linalg.eigvalsh(spread)[-1]))]
    for tau in hold.instants():
        rows = hold.moved(float(tau))
        reach = float(np.linalg.eigvalsh(rows @ inverse @ rows.T)[-1])
        place, radius = hold.reference.between(float(tau))
        room = offsets - normals @ place - radius
        limits += [(name, float(each), reach) for name, each in zip(hold.corridor.names, room, strict=True)]

    def largest(sag: float) -> tuple[float, str]:
        levels = [
            (max(room - (0.0 if name == "thrust" else sag), 0.0) ** 2 / reach, name)
            for name, room, reach in limits
        ]
        return min(levels)

    # Without sag it is too large: its size bounds that of the answer.
    level, name = largest(0.0)
    if level > 0.0:
        size = np.sqrt(
            level * np.array([np.linalg.eigvalsh(inverse[k : k + 2, k : k + 2])[-1] for k in (0, 2)])
        )
        level, name = largest(hold.sag(float(size[0]), float(size[1])))
    volume = 0.5 * math.pi**2 * level**2 / math.sqrt(float(np.linalg.det(hold.design.cost)))
    return Ellipsoid(level, name, volume, np.sqrt(level * np.diag(inverse)))


def polyhedron(hold: Hold, inner: Ellipsoid, phase: float) -> Polyhedron | None:
    """The set for a start with the body at ``phase`` rad; None without an ellipsoid, or if no attempt closes."""
    if inner.level <= 0.0:
        return None
    size = 8.0 * np.array([math.hypot(*inner.extents[:2]), math.hypot(*inner.extents[2:])])
    for _ in range(_ATTEMPTS):
        found = _closed(hold, inner, phase, hold.sag(float(size[0]), float(size[1])))
        if found is None:
            return None
        largest = _sizes(hold.design.closed_loop, found)
        if (largest <= size).all():
            return found
        size = 1.5 * largest
    return None


def _closed(hold: Hold, inner: Ellipsoid, phase: float, sag: float) -> Polyhedron | None:
    """Rows of more and more steps, until the vertices end in the ellipsoid."""
    steps = 4
    root: Floats = np.asarray(np.linalg.cholesky(hold.design.cost), dtype=np.float64)
    while steps <= _LONGEST:
        rows, bounds = _rows(hold, phase, steps, sag)
        if (bounds <= 0.0).any():
            return None
        found = _irredundant(rows, bounds, root, steps)
        if found is not None:
            last = found.vertices @ np.linalg.matrix_power(hold.design.closed_loop, steps + 1).T
            if (((last @ root) ** 2).sum(axis=1) <= inner.level).all():
                return found
        steps *= 2
    return None


def _rows(hold: Hold, phase: float, steps: int, sag: float) -> tuple[Floats, Floats]:
    normals = hold.corridor.normals / hold.corridor.lengths[:, None]
    offsets = hold.corridor.offsets / hold.corridor.lengths
    n, rate, step = hold.reference.mean_motion, hold.reference.rate, hold.reference.step
    angles = 2.0 * math.pi * (np.arange(SIDES) + 0.5) / SIDES
    disk = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    power = np.eye(4)
    rows, bounds = [], []
    for k in range(steps + 1):
        angle = phase + rate * step * k
        state, thrust = hold.reference.at(angle)
        for tau in hold.instants().tolist():
            turned = angle + rate * tau
            face = normals @ rotation(-turned)
            place = (planar_transition(n, tau) @ state + planar_input(n, tau) @ thrust)[:2]
            rows.append(face @ hold.moved(tau) @ power)
            bounds.append(offsets - face @ place - sag)
        rows.append(-disk @ hold.design.gain @ power)
        bounds.append(hold.usable - disk @ thrust)
        power = hold.design.closed_loop @ power
    return np.concatenate(rows), np.concatenate(bounds)


def _irredundant(rows: Floats, bounds: Floats, root: Floats, steps: int) -> Polyhedron | None:
    """By the polar body: rows / bounds on its hull are the faces, its facets are the vertices; None: unbounded."""
    # y = root' e has comparable components.
    polar = rows @ np.linalg.inv(root).T / bounds[:, None]
    hull = _hull(polar)
    if hull is None:
        return None
    normals, distances = hull.equations[:, :-1], hull.equations[:, -1]
    if not (distances < -1e-9).all():
        return None
    scaled = np.unique(np.round(-normals / distances[:, None], 12), axis=0)
    kept = np.sort(hull.vertices)
    solid = _hull(scaled)
    if solid is None:
        return None
    volume = float(solid.volume / abs(np.linalg.det(root)))
    return Polyhedron(rows[kept], bounds[kept], scaled @ np.linalg.inv(root), steps, volume)


def _hull(points: Floats) -> Any:
    """Qhull; where merged facets defeat it, with joggled points (relative 1e-10). None: the points are flat."""
    for options in ("Qt", "QJ"):
        try:
            return ConvexHull(points, qhull_options=options)
        except QhullError:
            continue
    return None


def _sizes(closed_loop: Floats, found: Polyhedron) -> Floats:
    """Largest |position| and |velocity| of the error at nodes 0 .. K + 1 over the set, (2,)."""
    most, states = np.zeros(2), found.vertices
    for _ in range(found.steps + 2):
        sizes = [np.linalg.norm(states[:, :2], axis=1).max(), np.linalg.norm(states[:, 2:], axis=1).max()]
        most = np.maximum(most, sizes)
        states = states @ closed_loop.T
    return most

"""All errors that the LQR corrects without leaving the corridor or the thrust limit: a polyhedron.

All e whose whole flight, from one angle of the body at the start, stays admissible. A unit face n of the body asks
n . R p <= b at all times, the thrust |u_ref - K e| <= a_max; each node and each instant between gives rows in e. Once
all vertices are inside the ellipsoid after K + 1 steps, later rows hold by themselves, and rows 0 .. K are all there
are.

What a distance may lose between the instants needs the size of the set itself: it is assumed, and checked with the set
that it gave.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from safestart.attitude.body_frame import rotation
from safestart.control.hold.ellipsoid import Ellipsoid
from safestart.control.hold.loop import SIDES, Hold
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.model.scenario import Floats

_FEWEST, _LONGEST = 4, 512
_ATTEMPTS = 8


@dataclass(frozen=True, slots=True)
class Polyhedron:
    """{``rows`` @ e <= ``bounds``}, irredundant; ``vertices`` (V, 4); ``steps`` K; volume in m^4/s^2."""

    rows: Floats
    bounds: Floats
    vertices: Floats
    steps: int
    volume: float


def polyhedron(hold: Hold, inner: Ellipsoid, phase: float) -> Polyhedron | None:
    """The set for a start with the body at ``phase`` rad; None without an ellipsoid, or if no attempt closes."""
    if inner.level <= 0.0:
        return None
    size = 8.0 * np.array([math.hypot(*inner.extents[:2]), math.hypot(*inner.extents[2:])])
    steps = _FEWEST
    for _ in range(_ATTEMPTS):
        closed = _closed(hold, inner, phase, hold.sag(float(size[0]), float(size[1])), steps)
        if closed is None:
            return None
        found, scaled = closed
        largest = _sizes(hold.closed, found)
        if (largest <= size).all():
            volume = _volume(hold, scaled)
            return None if volume is None else replace(found, volume=volume)
        # With other sags it takes as many steps, as a rule: fewer need not be tried.
        size, steps = 1.5 * largest, found.steps
    return None


def _closed(
    hold: Hold, inner: Ellipsoid, phase: float, sag: float, steps: int
) -> tuple[Polyhedron, Floats] | None:
    """Rows of more and more ``steps``, until the vertices end in the ellipsoid; see :func:`_irredundant`."""
    root: Floats = np.asarray(np.linalg.cholesky(hold.cost), dtype=np.float64)
    while steps <= _LONGEST:
        rows, bounds = _rows(hold, phase, steps, sag)
        if (bounds <= 0.0).any():
            return None
        found = _irredundant(rows, bounds, root, steps)
        if found is not None:
            last = found[0].vertices @ np.linalg.matrix_power(hold.closed, steps + 1).T
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
        power = hold.closed @ power
    return np.concatenate(rows), np.concatenate(bounds)


def _irredundant(rows: Floats, bounds: Floats, root: Floats, steps: int) -> tuple[Polyhedron, Floats] | None:
    """By the polar body: rows / bounds on its hull are the faces, its facets are the vertices; None: unbounded.

    Without its volume, which takes as long again; with the vertices y = root' e (V, 4), which give it.
    """
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
    return Polyhedron(rows[kept], bounds[kept], scaled @ np.linalg.inv(root), steps, math.nan), scaled


def _volume(hold: Hold, scaled: Floats) -> float | None:
    """Of a set with the vertices y = root' e (V, 4), m^4/s^2; None: Qhull fails."""
    root = np.linalg.cholesky(hold.cost)
    solid = _hull(scaled)
    return None if solid is None else float(solid.volume / abs(np.linalg.det(root)))


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

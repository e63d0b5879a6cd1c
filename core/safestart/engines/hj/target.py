"""The target function l: a state's distance from the corridor, fixed or turned, and from co-rotation.

The position-only target is the signed distance l(p). The velocity-aware one (paper 000, section 10) is
max(l(p), tau (|v - omega x p| - match)): at most 0 where the position is in the corridor and the velocity within
``match`` of that of a point fixed in the target's body. The velocity difference turns with the frame, so its length
does not depend on time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.attitude.body_frame import rotation
from safestart.constraints.corridor import corridor_of
from safestart.engines.base import Problem
from safestart.engines.hj.domain import Domain
from safestart.engines.hj.frame import Frame
from safestart.engines.hj.settings import Settings
from safestart.model.scenario import CorridorShape, Floats, SetKind

MATCH_S = 30.0
"""Seconds tau that convert a velocity difference into metres; the zero level does not depend on it."""


def signed_distance(shape: CorridorShape, points: Floats) -> Floats:
    """l = max over faces of (A_i p - b_i) / |A_i| in metres, shape (...): negative inside the corridor.

    Exact inside and beside a face; beyond an edge of the corridor it is less than the distance, with the same sign.
    """
    corridor = corridor_of(shape)
    distance: Floats = -(corridor.slack(points) / corridor.lengths).min(axis=-1)
    return distance


def mismatch(states: Floats, tumble_rate: float, frame: Frame, match: float) -> Floats:
    """tau (|v - omega x p| - match) in metres for states (..., 4); in the body frame v itself is that difference."""
    carried = tumble_rate if frame is Frame.LVLH else 0.0
    x, y, vx, vy = np.moveaxis(states, -1, 0)
    return np.asarray(MATCH_S * (np.hypot(vx + carried * y, vy - carried * x) - match))


def faces(shape: CorridorShape) -> Floats:
    """(k, 3) rows (A_i, -b_i) / |A_i|, so that l(p) = max_i of row_i . (p, 1)."""
    corridor = corridor_of(shape)
    return np.column_stack([corridor.normals, -corridor.offsets]) / corridor.lengths[:, None]


def target_at(problem: Problem, settings: Settings, states: Floats) -> Floats:
    """l at t = 0 for states (..., 4) in the frame of the settings, metres, shape (...)."""
    distance = signed_distance(problem.scenario.corridor, states[..., :2])
    if settings.match is None:
        return distance
    away = mismatch(states, problem.scenario.target.tumble_rate, settings.frame, settings.match)
    return np.maximum(distance, away)


@dataclass(frozen=True, slots=True)
class TargetValues:
    """l on the nodes of a grid, arrays (nx, ny, nvx, nvy) in metres, and the possible range of the value.

    ``terminal`` is l at the horizon, ``first`` l at t = 0; they differ if the corridor turns. The value of a
    fixed-time set stays in the range of ``terminal``; a tube's may also take any lower value that l has on its
    way: ``low`` and ``high`` bound it. With ``match`` in the settings l is the velocity-aware one.
    """

    terminal: Floats
    first: Floats
    low: float
    high: float

    @classmethod
    def of(cls, problem: Problem, domain: Domain, settings: Settings) -> TargetValues:
        """Evaluate on the nodes of a box.

        In LVLH axes the corridor has turned by omega_t t: l(R(-omega_t t) p). Of all points at one distance from the
        target, the one on the corridor's axis has the least l (l is convex and even in x), and l falls along the axis.
        So l there, at the distance of the box's corner, is the minimum over all angles.
        """
        x, y, _, _ = domain.axes(settings.shape)
        points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
        shape = problem.scenario.corridor

        def spread(positions: Floats) -> Floats:
            distance = signed_distance(shape, positions)[:, :, None, None]
            return np.broadcast_to(distance, settings.shape)

        first = terminal = spread(points)
        turns = settings.frame is Frame.LVLH and problem.scenario.target.tumble_rate != 0.0
        if turns:
            # Row vectors: p @ R(theta) is R(-theta) p.
            terminal = spread(points @ rotation(problem.scenario.target.tumble_rate * problem.horizon))
        low, high = float(terminal.min()), float(terminal.max())
        if turns and problem.kind is SetKind.TUBE:
            corner = np.array([0.0, np.hypot(domain.half[0], domain.half[1])])
            low = float(signed_distance(shape, corner))
        if settings.match is not None:
            nodes = np.stack(np.meshgrid(*domain.axes(settings.shape), indexing="ij"), axis=-1)
            away = mismatch(nodes, problem.scenario.target.tumble_rate, settings.frame, settings.match)
            first, terminal = np.maximum(first, away), np.maximum(terminal, away)
            low, high = max(low, float(away.min())), float(terminal.max())
        return cls(terminal, first, low, high)

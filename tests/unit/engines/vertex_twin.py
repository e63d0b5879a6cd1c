"""The paper's criterion of the forward set: some vertex of the target polygon lies in the outer polygon."""

from __future__ import annotations

import numpy as np

from safestart.engines.base import Problem
from safestart.engines.forward import constants, template
from safestart.engines.sampled import steps, to_body
from safestart.model.scenario import CorridorShape, Floats
from safestart.sets.cone import directions


def target_vertices(shape: CorridorShape, y_max: float) -> Floats:
    """Vertices (4, 2) of the corridor cut at ``y_max``, body axes, metres."""
    half = shape.x0 + shape.c_x * (y_max - shape.hold_radius)
    low = shape.hold_radius
    return np.array([[-shape.x0, low], [shape.x0, low], [half, y_max], [-half, y_max]])


def vertex_margin(problem: Problem) -> Floats:
    """Largest over steps and vertices of the least slack among the polygon's faces, (ny, nx), metres."""
    points = problem.points().reshape(-1, 2)
    margin = np.full(len(points), -np.inf)
    for step in steps(problem):
        unit = directions(template() + step.theta)
        supports = constants(step, template(), problem.scenario.chaser.max_acceleration)
        moved = points @ to_body(step.drift.T, step.theta) @ unit.T + supports
        for vertex in target_vertices(problem.scenario.corridor, problem.grid.y_max):
            np.maximum(margin, (moved - unit @ vertex).min(axis=1), out=margin)
    return margin.reshape(problem.grid.ny, problem.grid.nx)

"""The forward engine as paper 000 words it: recursion (10) per cell and direction, then a vertex test."""

from __future__ import annotations

import math

import numpy as np

from safestart.attitude.body_frame import rotation
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.engines.base import Problem
from safestart.model.scenario import Bools, Floats, Rest

DIRECTIONS = 48


def support(start: Floats, direction: Floats, steps: int, a: Floats, b: Floats, a_max: float) -> float:
    """h_steps(d) of the state set from ``start`` (4,): h_{k+1}(d) = h_k(A^T d) + a_max |B^T d|_1."""
    if steps == 0:
        return float(direction @ start)
    return support(start, a.T @ direction, steps - 1, a, b, a_max) + a_max * float(
        np.abs(b.T @ direction).sum()
    )


def cell(problem: Problem, point: Floats, a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Template directions (48, 2) in LVLH and supports (48,) of one body-frame start at step N."""
    target = problem.scenario.target
    x, y = float(point[0]), float(point[1])
    omega = target.tumble_rate if problem.rest is Rest.BODY else 0.0
    start = np.array([x, y, -omega * y, omega * x])
    unit = np.empty((DIRECTIONS, 2))
    supports = np.empty(DIRECTIONS)
    for i in range(DIRECTIONS):
        angle = 2.0 * math.pi * i / DIRECTIONS
        unit[i] = math.sin(angle), math.cos(angle)
        direction = np.array([unit[i, 0], unit[i, 1], 0.0, 0.0])
        a_max = problem.scenario.chaser.max_acceleration
        supports[i] = support(start, direction, problem.steps, a, b, a_max)
    return unit, supports


def literal_map(problem: Problem, cells: slice = slice(None)) -> tuple[Bools, Floats]:
    """Vertex criterion of some cells (row-major slice), fixed time: verdicts (P,) and supports (P, 48).

    Not restricted to the corridor.
    """
    shape, target = problem.scenario.corridor, problem.scenario.target
    half = shape.x0 + shape.c_x * (problem.grid.y_max - shape.hold_radius)
    low, high = shape.hold_radius, problem.grid.y_max
    corners = np.array([[-shape.x0, low], [shape.x0, low], [half, high], [-half, high]])
    corners = corners @ rotation(target.tumble_rate * problem.horizon).T
    a, b = planar_transition(target.mean_motion, problem.dt), planar_input(target.mean_motion, problem.dt)
    verdicts, all_supports = [], []
    for point in problem.points().reshape(-1, 2)[cells]:
        unit, supports = cell(problem, point, a, b)
        verdicts.append(any(bool((unit @ corner <= supports).all()) for corner in corners))
        all_supports.append(supports)
    return np.array(verdicts), np.array(all_supports)

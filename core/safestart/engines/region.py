"""Shared by the set-based engines: restriction of a set of starts to the corridor, and rest at the start."""

from __future__ import annotations

import numpy as np

from safestart.constraints.corridor import corridor_of
from safestart.engines.base import Problem
from safestart.model.scenario import Bools, Floats, Rest, Scenario

ROUND_OFF = 1e-9
"""Metres by which a closed set may miss a point that lies on its boundary (the corridor's edge at t = 0)."""


def start_velocity(scenario: Scenario, rest: Rest) -> Floats:
    """Matrix (2, 2) from start position to LVLH start velocity: 0, or omega x p for rest in the body (eq. 5)."""
    omega = scenario.target.tumble_rate if rest is Rest.BODY else 0.0
    return np.array([[0.0, -omega], [omega, 0.0]])


def restrict(problem: Problem, reach: Floats) -> tuple[Bools, Floats]:
    """Mask and margin (ny, nx) of a set with margin ``reach`` (ny, nx), restricted to the corridor at t = 0.

    The margin is the smaller of ``reach`` and the distance to the corridor's nearest face, in metres; the mask
    is exactly where it is >= 0.
    """
    corridor = corridor_of(problem.scenario.corridor)
    faces = corridor.slack(problem.points())
    faces /= corridor.lengths
    slack = np.minimum(np.minimum(faces[..., 0], faces[..., 1]), faces[..., 2])
    mask = (slack >= 0.0) & (reach >= -ROUND_OFF)
    margin = np.minimum(reach, slack)
    return mask, np.maximum(margin, 0.0, out=margin, where=mask)

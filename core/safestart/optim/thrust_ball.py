"""Thrusts u_k of norm at most a_max: as blocks of a cone program, as a projection, as a bound on weighted rows.

A program has them as its variable ``thrust``, w_k = u_k / a_max in the unit ball, ordered by interval, then component.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from safestart.model.scenario import Floats
from safestart.optim.cone_program import ConeProgram, Each

INSIDE = 1.0 - 1e-14
"""Slightly inside the ball, so that the norm is within a_max in exact arithmetic too."""


def keep_in_balls(program: ConeProgram, count: int, dimensions: int, radius: str = "") -> None:
    """Add |w_k| <= 1 for ``count`` thrusts, or |w_k| <= r_k with ``radius`` the name of the variable r (N,)."""
    ball = _balls(count, dimensions)
    if radius:
        program.norms("balls", np.zeros_like(ball.unit), thrust=ball.thrust, **{radius: ball.heads})
    else:
        program.norms("balls", ball.unit, thrust=ball.thrust)


class _Balls(NamedTuple):
    """``unit`` (N, d + 1): radius 1; the rows where thrust components and radii enter."""

    unit: Floats
    thrust: Each
    heads: Each


@lru_cache(maxsize=16)
def _balls(count: int, dimensions: int) -> _Balls:
    cone = dimensions + 1
    unit = np.zeros((count, cone))
    unit[:, 0] = 1.0
    components = np.arange(count * dimensions)
    rows = cone * (components // dimensions) + 1 + components % dimensions
    return _Balls(unit, Each(rows[:, None]), Each(cone * np.arange(count)[:, None]))


def into_balls(w: Floats) -> Floats:
    """Thrusts (N, d) in units of a_max; those slightly outside the unit ball are scaled back into it."""
    norms = np.sqrt(np.add.reduce(w * w, axis=1))
    inside: Floats = w * (INSIDE / np.maximum(norms, INSIDE))[:, None]
    return inside


def bound(constant: Floats, thrust: Floats, weights: Floats, a_max: float, dimensions: int) -> float:
    """Largest weighted sum of the rows (m) over all thrust histories: with weights (J,) of sum 1, a margin's bound."""
    pull = (weights @ thrust).reshape(-1, dimensions)
    reach = np.add.reduce(np.sqrt(np.add.reduce(pull * pull, axis=1)))
    return float(weights @ constant + a_max * reach)

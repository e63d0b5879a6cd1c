"""Which sums w = u + d Player 1 can realise against every d: decided exactly, in rational numbers.

Each part of the control is a ball of radius a. The sum must lie in it with room for d: |w| + s <= a, with s the root of
the sum of squares of the disturbance's radii that meet this part. Doubles are rationals, so both sides of the squared
inequality are known exactly.
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import lru_cache

import numpy as np

from safestart.collision_avoidance.game import Game
from safestart.collision_avoidance.inputs import meeting
from safestart.model.scenario import Bools, Floats

INSIDE = 1.0 - 1e-13
"""The search uses balls smaller by this factor, so that inputs stay admissible after the rounding of a hundred
steps."""
_SQUARES = 1.0 - 4e-15
"""Allowance for the rounding of a sum of three squares and of their limit."""
_SMALLEST = 1e-100


def fits(square: Fraction, radius: float, others: tuple[float, ...]) -> bool:
    """Whether sqrt(square) + sqrt(sum of the squares of ``others``) <= ``radius``."""
    taken = sum((Fraction(e) ** 2 for e in others), Fraction(0))
    whole = Fraction(radius) ** 2
    left = whole + taken - square
    # (radius - s)^2 >= square and s <= radius, with s = sqrt(taken) moved to the other side and squared.
    return taken <= whole and left >= 0 and 4 * whole * taken <= left * left


@lru_cache(maxsize=32)
def inner_radii(game: Game) -> tuple[float, ...] | None:
    """By part of the control, a radius of sums that Player 1 can certainly realise; None if there are none."""
    out = []
    for part in game.control.parts:
        others = tuple(other.radius for other in meeting(part, game.disturbance.parts))
        if not fits(Fraction(0), part.radius, others):
            return None
        radius = max(part.radius - math.hypot(*others), 0.0)
        while radius > 0.0 and not fits(Fraction(radius) ** 2, part.radius, others):
            radius = radius * (1.0 - 2.0**-52) if radius > _SMALLEST else 0.0
        out.append(radius if radius > _SMALLEST else 0.0)
    return tuple(out)


def square_limits(radii: tuple[float, ...]) -> Floats:
    """Limits (parts,) on sums of squares in doubles that keep the vector in its ball."""
    return np.array([_SQUARES * radius * radius for radius in radii])


def realisable(game: Game, inputs: Floats) -> Bools:
    """Whether Player 1 can realise all sums (..., J, m) against every d, exactly; (...)."""
    flat, radii = inputs.reshape(-1, *inputs.shape[-2:]), inner_radii(game)
    found = np.full(len(flat), radii is not None)
    if radii is None:
        return found.reshape(inputs.shape[:-2])
    for part, limit in zip(game.control.parts, square_limits(radii).tolist(), strict=True):
        others = tuple(other.radius for other in meeting(part, game.disturbance.parts))
        pieces = flat[..., part.begin : part.end]
        # Doubles settle the clear cases; rationals decide only the rest.
        for k, j in np.argwhere(~((pieces * pieces).sum(axis=-1) <= limit)).tolist():
            piece = pieces[k, j].tolist()
            finite = all(map(math.isfinite, piece))
            found[k] &= finite and fits(
                sum((Fraction(e) ** 2 for e in piece), Fraction(0)), part.radius, others
            )
    return found.reshape(inputs.shape[:-2])

"""Planar zonotopes {sum_i w_i g_i : |w_i| <= 1}: their support over the corridor's dual arc."""

from __future__ import annotations

import numpy as np

from safestart.model.scenario import Floats
from safestart.sets.cone import DualArc
from safestart.sets.cone_meets import MeetArc


def support(generators: Floats, unit: Floats) -> Floats:
    """sigma(d) = sum_i |g_i . d| for generators (G, 2) and directions (..., 2)."""
    return np.asarray(np.abs(unit @ generators.T).sum(axis=-1))


def meet_arc(generators: Floats, arc: DualArc) -> MeetArc:
    """Breakpoints and vertices of the zonotope of ``generators`` (G, 2), body axes, over the dual arc.

    The breakpoints are the generators' normals inside the arc; the port's segment x0 (1, 0) is one more generator. In
    angular order each breakpoint flips the sign of one generator: O(G log G).
    """
    both = np.vstack([generators, [[arc.half_width, 0.0]]])
    both = both[(both != 0.0).any(axis=1)]
    # g . d(a) = g_x sin a + g_y cos a vanishes at tan a = -g_y / g_x.
    with np.errstate(divide="ignore"):
        normal = np.arctan(-both[:, 1] / both[:, 0])
    inside = np.abs(normal) < arc.half_angle
    order = np.argsort(normal[inside], kind="stable")
    angles = np.concatenate([[-arc.half_angle], normal[inside][order], [arc.half_angle]])
    # Before its normal a generator with g_x > 0 has g . d < 0, after it > 0; outside the arc the sign is fixed.
    sign = np.where(inside, -np.sign(both[:, 0]), np.sign(both[:, 1]))
    first = (sign[:, None] * both).sum(axis=0) - [0.0, arc.hold]
    flips = -2.0 * (sign[:, None] * both)[inside][order]
    return MeetArc.of(angles, first + np.vstack([np.zeros((1, 2)), np.cumsum(flips, axis=0)]))

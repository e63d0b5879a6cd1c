"""Outer polygon {p : d_i . p <= h_i} of a set given by its support in template directions."""

from __future__ import annotations

import numpy as np

from safestart.model.scenario import Floats
from safestart.sets.cone import DualArc, directions
from safestart.sets.cone_meets import MeetArc


def meet_arc(turned: Floats, supports: Floats, arc: DualArc) -> MeetArc:
    """The outer polygon over the dual arc; ``turned`` (n,) are the template's angles a (rad), in body axes.

    ``supports`` (n,) must be values of one support function, and neighbouring directions less than half a turn
    apart: then every face touches the polygon and neighbours meet in its vertices.
    """
    turned = np.mod(turned + np.pi, 2.0 * np.pi) - np.pi
    order = np.argsort(turned, kind="stable")
    angle, support = turned[order], supports[order]
    unit = directions(angle)
    right, above = np.roll(unit, -1, axis=0), np.roll(support, -1)
    determinant = unit[:, 0] * right[:, 1] - unit[:, 1] * right[:, 0]
    corner = np.stack(
        [
            (support * right[:, 1] - above * unit[:, 1]) / determinant,
            (above * unit[:, 0] - support * right[:, 0]) / determinant,
        ],
        axis=-1,
    )
    within = angle[np.abs(angle) < arc.half_angle]
    ends = [-arc.half_angle, 0.0, arc.half_angle]
    breaks = np.unique(np.concatenate([ends, within]))
    middle = 0.5 * (breaks[:-1] + breaks[1:])
    # Piece i runs from template direction i to i + 1; index -1 is the one across +-pi.
    vertices = corner[np.searchsorted(angle, middle) - 1]
    port = np.stack([arc.half_width * np.sign(middle), np.full(len(middle), -arc.hold)], axis=-1)
    return MeetArc.of(breaks, vertices + port)

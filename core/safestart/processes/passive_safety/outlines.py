"""Outlines of planar zonotopes, for pictures."""

from __future__ import annotations

import numpy as np

from safestart.model.scenario import Floats


def outlines(centre: Floats, gens: Floats) -> Floats:
    """Vertices (N, 2 m, 2) of the zonotopes ``centre`` (N, 2), ``gens`` (N, m, 2), counter-clockwise."""
    upward = np.where((gens[..., 1:] < 0.0) | ((gens[..., 1:] == 0.0) & (gens[..., :1] < 0.0)), -gens, gens)
    order = np.argsort(np.arctan2(upward[..., 1], upward[..., 0]), axis=1)
    sides = 2.0 * np.take_along_axis(upward, order[..., None], axis=1)
    lowest = centre - upward.sum(axis=1)
    half = lowest[:, None, :] + np.cumsum(sides, axis=1)
    return np.concatenate([half, 2.0 * centre[:, None, :] - half], axis=1)

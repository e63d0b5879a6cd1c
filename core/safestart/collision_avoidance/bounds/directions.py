"""Unit vectors that cover the circle or the sphere, and the largest gap to any direction."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from scipy.spatial import ConvexHull

from safestart.model.scenario import Floats

CIRCLE, SPHERE = 512, 1200


@cache
def covering(dimension: int) -> tuple[Floats, float]:
    """Directions (K, dimension) and the factor c with |v| <= c * max over k of s_k . v for every vector v."""
    if dimension == 1:
        return np.array([[1.0], [-1.0]]), 1.0
    if dimension == 2:
        angles = 2.0 * math.pi / CIRCLE * np.arange(CIRCLE)
        return np.stack([np.cos(angles), np.sin(angles)], axis=1), 1.0 / math.cos(math.pi / CIRCLE)
    k = np.arange(SPHERE) + 0.5
    height, turn = 1.0 - 2.0 * k / SPHERE, math.pi * (1.0 + math.sqrt(5.0)) * k
    ring = np.sqrt(1.0 - height * height)
    points = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1)
    # The direction farthest from all points is over the middle of a facet; its cosine is the facet's distance.
    return points, float(1.0 / np.min(-ConvexHull(points).equations[:, -1]))


def guesses(dimension: int) -> Floats:
    """A few directions (G, dimension) to try first, zero among them."""
    if dimension == 1:
        return np.array([[0.0], [1.0], [-1.0]])
    if dimension == 2:
        angles = 2.0 * math.pi / 16.0 * np.arange(16)
        circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        return np.concatenate([np.zeros((1, 2)), circle])
    cube = np.stack(np.meshgrid(*[[0.0, 1.0, -1.0]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    return np.asarray(cube, dtype=np.float64)

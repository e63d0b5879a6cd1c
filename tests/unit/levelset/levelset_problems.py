"""Motions, lattices and values that the tests of the level-set solver share."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.levelset import Ball, Box, Lattice, ValueField, solve
from safestart.levelset.dynamics import Rates

SHAPES = {2: (9, 12), 3: (8, 13, 7), 4: (7, 9, 6, 8), 5: (5, 6, 5, 7, 5), 6: (5, 5, 6, 5, 5, 5)}


def wavy(lattice: Lattice) -> np.ndarray:
    """Something with slopes of either sign, kinks and no symmetry."""
    x = lattice.coordinates()
    smooth = sum(np.sin(1.3 * (i + 1) * c + i) for i, c in enumerate(x))
    return np.asarray(
        np.maximum(smooth, 0.4 - x[0]) + 0.3 * np.random.default_rng(5).standard_normal(lattice.shape)
    )


@dataclass(frozen=True)
class Rough:
    """State- and time-dependent drift and gains on every axis: nothing a table could leave out."""

    n: int
    separable: bool = False
    varies: bool = True

    @property
    def bounds(self) -> list[Any]:
        if self.separable:
            return [(Box(np.array([-0.5, -1.0]), np.array([0.7, 1.0])), "min", 0.0)]
        return [
            (Ball(np.array([0.1, -0.2]), 0.8), "min", 0.0),
            (Box(np.array([-0.3, -0.2]), np.array([0.3, 0.2])), "max", 0.05),
        ]

    def rates(self, lattice: Lattice, time: float) -> Rates:
        x = lattice.coordinates()
        n = self.n
        drift = [[np.cos(x[i - 1] + time), x[i] * x[i - 2], 0.1 * x[0]] for i in range(n)]
        if self.separable:
            columns = [[np.cos(x[-1]) if i == c else None for i in range(n)] for c in (0, 1)]
            return Rates(drift, [columns])
        first = [[np.sin(x[i - 1]) + c for i in range(n)] for c in (0, 1)]
        second = [[np.ones((1,) * n) if i == c else None for i in range(n)] for c in (0, 1)]
        return Rates(drift, [first, second])

    def gains_at(self, states: np.ndarray, time: float) -> list[np.ndarray]:
        """G (..., n, 2) per input, of the same functions as the rates on the nodes."""
        n, two = self.n, np.zeros((*states.shape, 2))
        if self.separable:
            two[..., [0, 1], [0, 1]] = np.cos(states[..., -1:])
            return [two]
        before = np.sin(np.roll(states, 1, axis=-1))
        return [np.stack([before, before + 1.0], axis=-1), two + np.eye(n)[:, :2]]


def rough_lattice(n: int, boundary: str) -> Lattice:
    return Lattice.of([-1.0] * n, [1.0 + 0.1 * i for i in range(n)], SHAPES[n], boundary)


DOUBLE = np.array([[0.0, 1.0], [0.0, 0.0]])
PUSH = np.array([[0.0], [1.0]])


def box(half: float) -> Box:
    return Box(np.array([-half]), np.array([half]))


def solved(*arguments: Any, **options: Any) -> ValueField:
    solution = solve(*arguments, **options)
    assert solution.field is not None, solution.failure
    return solution.field

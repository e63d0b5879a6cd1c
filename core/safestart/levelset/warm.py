"""Compile the kernels of one precision, or load them from Numba's cache."""

from __future__ import annotations

import time

import numpy as np

from safestart.levelset.dynamics import Box, Input, Linear
from safestart.levelset.lattice import Lattice
from safestart.levelset.march import Options
from safestart.levelset.scheme import Scheme
from safestart.levelset.solution import solve

_warm: set[str] = set()


def warm(precision: str = "float64") -> float:
    """Returns the seconds it took, 0 the second time; dimensions, scheme and inputs are data of one compiled kernel."""
    if precision in _warm:
        return 0.0
    start = time.perf_counter()
    lattice = Lattice.of([-1.0, -1.0], [1.0, 1.0], [5, 5])
    x, y = lattice.coordinates()
    push = Input(np.eye(2), Box(-np.ones(2), np.ones(2)), "min")
    solution = solve(
        lattice,
        Linear(np.zeros((2, 2)), (push,)),
        x + y,
        0.01,
        options=Options(Scheme.FIRST, precision=precision),
    )
    if solution.field is not None:
        solution.field.read(np.zeros((1, 2)))
    _warm.add(precision)
    return time.perf_counter() - start

"""The largest last variable under cones, by Clarabel: the oracle of both deciders."""

from __future__ import annotations

from typing import Any

import clarabel
import numpy as np
from scipy.sparse import csc_array


def largest(a: np.ndarray, b: np.ndarray, cones: list[Any]) -> tuple[Any, bool]:
    """The solution for the largest x[-1], x (n,), for which b - a x lies in the cones; whether it was found."""
    columns = a.shape[1]
    cost = np.zeros(columns)
    cost[-1] = -1.0
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_threads = False, 1
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-9
    nothing = csc_array((columns, columns))
    found = clarabel.DefaultSolver(nothing, cost, csc_array(a), b, cones, settings).solve()
    return found, str(found.status) in ("Solved", "AlmostSolved")

"""The compiled interior-point method of the exact answers beside the cone solver, on the same programs.

``python -m benchmarks.compiled_margin [STARTS] [SEED]`` prints one JSON document. The programs are those of the exact
answers to the starts of :mod:`benchmarks.exact_answers`.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from statistics import median
from typing import Any

import numpy as np
import pytest

from benchmarks.asked import parser
from benchmarks.exact_answers import draw
from benchmarks.timing import once
from safestart.exact import search
from safestart.exact.answer import TOLERANCE
from safestart.exact.watch import watch_of
from safestart.model.scenario import Floats
from safestart.optim.ball_margin import SOLVED, largest_margin
from safestart.optim.largest_margin import Solved, solve, solve_by_cones

FINE_M, COARSE_M = 1e-8, 2e-5
Program = tuple[Floats, Floats, float, int, bool]


def programs(count: int, seed: int) -> list[Program]:
    """Constant, rows, a_max, dimensions and whether the fine solution is asked for, of every round of every answer."""
    seen: list[Program] = []

    def kept(
        constant: Floats, rows: Floats, a_max: float, d: int, norms: int, *, fine: bool, **how: Any
    ) -> Solved:
        seen.append((constant, rows, a_max, d, fine))
        return solve(constant, rows, a_max, d, norms, fine=fine, **how)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(search, "solve", kept)
        for question, state in draw(count, seed):
            search.Search(watch_of(question), state).narrow(TOLERANCE)
    return seen


def study(count: int, seed: int) -> dict[str, Any]:
    """Median times of both, how often the compiled method settles, and how far the two optima lie apart."""
    cones_s, compiled_s, apart = [], [], []
    statuses, iterations = Counter[int](), []
    for constant, rows, a_max, d, fine in programs(count, seed):
        found: dict[str, Any] = {}
        tolerance = FINE_M if fine else COARSE_M

        def cones(
            found: dict[str, Any] = found, given: Any = (constant, rows, a_max, d), fine: bool = fine
        ) -> None:
            found["cones"] = solve_by_cones(*given, fine=fine)

        def compiled(
            found: dict[str, Any] = found,
            given: Any = (constant, rows, a_max, d),
            tolerance: float = tolerance,
        ) -> None:
            found["compiled"] = largest_margin(given[0], given[2] * given[1], given[3], tolerance)

        if not compiled_s:
            compiled()
        cones_s.append(once(cones))
        compiled_s.append(once(compiled))
        w, _, status, count_of = found["compiled"]
        statuses[status] += 1
        iterations.append(count_of)
        if status == SOLVED:
            apart.append(abs(float((constant + a_max * rows @ w).min()) - found["cones"].bound))
    return {
        "programs": len(cones_s),
        "settled": statuses[SOLVED],
        "iterations": {"mean": float(np.mean(iterations)), "most": max(iterations)},
        "cone_solver_s": median(cones_s),
        "compiled_s": median(compiled_s),
        "ratio_of_medians": median(cones_s) / median(compiled_s),
        "farthest_apart_m": max(apart),
    }


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("count", nargs="?", type=int, default=200)
    asked.add_argument("seed", nargs="?", type=int, default=3)
    given = asked.parse_args()
    sys.stdout.write(json.dumps(study(given.count, given.seed), indent=2) + "\n")

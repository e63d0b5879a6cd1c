"""Run every hot kernel once, so that compilation does not fall into the first job."""

from __future__ import annotations

from safestart.engines.base import Problem
from safestart.engines.registry import ENGINE_NAMES, engine
from safestart.progress import Context
from safestart.scenario import Grid, Scenario

# Its compilation is per grid shape and costs as much as a small solve: nothing to gain ahead of the job.
_NOT_WORTH_IT = frozenset({"hamilton_jacobi"})


def warm() -> None:
    """Solve one tiny problem with each engine; the compiled kernels stay in this process and in Numba's cache."""
    problem = Problem(Scenario.of(3.0, 0.1), Grid(3, 3, 60.0), horizon=4.0, dt=2.0)
    for name in ENGINE_NAMES:
        if name not in _NOT_WORTH_IT:
            engine(name).solve(problem, Context())

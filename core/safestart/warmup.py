"""Run every hot kernel once, so that compilation does not fall into the first job."""

from __future__ import annotations

import numpy as np

from safestart.avoidance.warm import warm as warm_avoidance
from safestart.engines.base import Problem
from safestart.engines.registry import ENGINE_NAMES, engine
from safestart.guidance.worlds import CwhWorld
from safestart.levelset.warm import warm as warm_levelset
from safestart.progress import Context
from safestart.scenario import Grid, Scenario


def warm() -> None:
    """Solve one tiny problem with each engine; the compiled kernels stay in this process and in Numba's cache.

    The level-set solver is compiled per precision; the engine asks for float32 only.
    """
    problem = Problem(Scenario.of(3.0, 0.1), Grid(3, 3, 60.0), horizon=4.0, dt=2.0)
    for name in ENGINE_NAMES:
        engine(name).solve(problem, Context())
    CwhWorld(problem.scenario, np.array([0.0, 30.0, 0.0, 0.0, 0.0, 0.0]), problem.dt).fly(np.zeros(2))
    warm_levelset("float64")
    warm_avoidance()

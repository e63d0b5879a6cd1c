"""Run every hot kernel once, so that the first job does not wait for compilation.

Several processes can compile parts at the same time and share the results through Numba's cache on disk. No two parts
have a large kernel in common, which both would compile. A process names the parts that its jobs need (``kernels`` of
its spec): a worker compiles those first that a waiting job needs.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import MappingProxyType

import numpy as np

from safestart.collision_avoidance.warm import warm as avoidance
from safestart.constraints.corridor import corridor_of
from safestart.engines.base import Problem
from safestart.engines.load import engine
from safestart.engines.registry import ENGINES
from safestart.exact.kernels.warm import warm as exact_answers
from safestart.levelset.warm import warm as compile_levelset
from safestart.model.scenario import Grid, Scenario
from safestart.passive_safety.warm import warm as passive_safety
from safestart.runtime.progress import Context
from safestart.simulation.planar import watched_flight
from safestart.simulation.plant import plant_of

_PROBLEM = Problem(Scenario.of(3.0, 0.1), Grid(3, 3, 60.0), horizon=4.0, dt=2.0)


def _flights() -> None:
    engine("monte_carlo").solve(_PROBLEM, Context())
    start = np.array([0.0, 30.0, 0.0, 0.0, 0.0, 0.0])
    scenario = _PROBLEM.scenario
    watched_flight(plant_of(scenario), [corridor_of(scenario.corridor)], start, _PROBLEM.dt).fly(np.zeros(3))


def _level_sets() -> None:
    compile_levelset("float32")


def _double_level_sets() -> None:
    compile_levelset("float64")


def _sets() -> None:
    for name in ENGINES:
        if name not in ("monte_carlo", "hamilton_jacobi", "tracking"):
            engine(name).solve(_PROBLEM, Context())


def _tracking() -> None:
    engine("tracking").solve(_PROBLEM, Context())


PARTS = MappingProxyType[str, Callable[[], None]](
    {
        "flights": _flights,
        "level sets": _level_sets,
        "reachable sets": _sets,
        "exact answers": exact_answers,
        "tracking": _tracking,
        "level sets in double precision": _double_level_sets,
        "collision avoidance": avoidance,
        "passive safety": passive_safety,
    }
)
"""What to compile, by name, first what a benchmark needs, then slowest first."""


def warm(*parts: str) -> None:
    """Solve a tiny problem for each named part, or for all; kernels stay in this process and in Numba's cache."""
    with _nothing_collected():
        for part in parts or PARTS:
            PARTS[part]()


@contextmanager
def _nothing_collected() -> Iterator[None]:
    """A compiler's trees live until it ends: a collector that looks through them again and again takes 8 % of its time."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()

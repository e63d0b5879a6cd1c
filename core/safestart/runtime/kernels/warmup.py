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
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from safestart.engines.base import Problem

# Every part imports what it warms up: who names the parts, or compiles one, waits for the modules of no other.


def _problem() -> Problem:
    from safestart.engines.base import Problem
    from safestart.model.scenario import Grid, Scenario

    return Problem(Scenario.of(3.0, 0.1), Grid(3, 3, 60.0), horizon=4.0, dt=2.0)


def _solved(*engines: str) -> None:
    from safestart.engines.load import engine
    from safestart.runtime.progress import Context

    for name in engines:
        engine(name).solve(_problem(), Context())


def _flights() -> None:
    _solved("monte_carlo")


def _level_sets() -> None:
    from safestart.levelset.warm import warm

    warm("float32")


def _double_level_sets() -> None:
    from safestart.levelset.warm import warm

    warm("float64")


def _sets() -> None:
    from safestart.engines.registry import ENGINES

    _solved(*(name for name in ENGINES if name not in ("monte_carlo", "hamilton_jacobi", "tracking")))


def _exact_answers() -> None:
    import numpy as np

    from safestart.constraints.corridor import corridor_of
    from safestart.exact.kernels.warm import warm
    from safestart.simulation.planar import watched_flight
    from safestart.simulation.plant import plant_of

    warm()
    # A flight that is watched step by step, with a controller that asks the exact question.
    problem, start = _problem(), np.array([0.0, 30.0, 0.0, 0.0, 0.0, 0.0])
    scenario = problem.scenario
    watched_flight(plant_of(scenario), [corridor_of(scenario.corridor)], start, problem.dt).fly(np.zeros(3))


def _tracking() -> None:
    _solved("tracking")


def _avoidance() -> None:
    from safestart.collision_avoidance.warm import warm

    warm()


def _passive_safety() -> None:
    from safestart.passive_safety.warm import warm

    warm()


PARTS = MappingProxyType[str, Callable[[], None]](
    {
        "flights": _flights,
        "level sets": _level_sets,
        "reachable sets": _sets,
        "exact answers": _exact_answers,
        "tracking": _tracking,
        "level sets in double precision": _double_level_sets,
        "collision avoidance": _avoidance,
        "passive safety": _passive_safety,
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
    """A compiler's trees live until it ends; a collector that looks through them again takes 8 % of its time."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()

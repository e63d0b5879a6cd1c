"""The one interface of all engines: a problem in, a mask with margin, timings and a result code out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Protocol

import numpy as np

from safestart.constraints.corridor import corridor_of
from safestart.errors import UnfitResult, invalid
from safestart.model.scenario import Bools, Floats, Grid, Rest, Scenario, SetKind, number
from safestart.runtime.progress import Context

MAX_HORIZON = 3600.0


class ResultCode(StrEnum):
    """How a computation ended. Only ``OK`` comes with a mask."""

    OK = "ok"
    NUMERICAL_FAILURE = "numerical_failure"
    NOT_APPLICABLE = "not_applicable"


@dataclass(frozen=True, slots=True)
class Problem:
    """The question to an engine: which starts of the grid, at rest, belong to its set.

    ``horizon`` and ``dt`` in seconds (``dt`` is the control interval of the sampled engines; the horizon is a
    whole number of them).
    """

    scenario: Scenario
    grid: Grid = field(default_factory=Grid)
    horizon: float = 40.0
    dt: float = 2.0
    rest: Rest = Rest.LVLH
    kind: SetKind = SetKind.FIXED

    def __post_init__(self) -> None:
        number("horizon", self.horizon, 0.0, MAX_HORIZON, open_low=True)
        number("dt", self.dt, 0.0, self.horizon, open_low=True)
        if abs(self.steps * self.dt - self.horizon) > 1e-9 * self.horizon:
            raise invalid("horizon", f"a whole number of intervals of {self.dt:g} s", self.horizon)
        self.grid.axes(self.scenario.corridor)

    @property
    def steps(self) -> int:
        """Number of control intervals N = horizon / dt."""
        return round(self.horizon / self.dt)

    def points(self) -> Floats:
        """Body-frame start positions (ny, nx, 2) in metres."""
        return self.grid.points(self.scenario.corridor)

    def inside(self) -> Bools:
        """Grid points inside the corridor at t = 0, (ny, nx), to which every engine's region is restricted."""
        return corridor_of(self.scenario.corridor).contains(self.points())


@dataclass(frozen=True, slots=True)
class EngineResult:
    """Answer of an engine.

    ``mask`` (ny, nx) is True where the start belongs to the engine's set; None unless ``code`` is OK.
    ``margin`` (ny, nx), metres, positive inside, for engines that have one. ``compile_s`` is the time for compilation
    and not part of ``run_s``. ``detail`` holds JSON-able facts (variant, grid, bounds); ``arrays`` further arrays to
    store (value slices).
    """

    code: ResultCode
    mask: Bools | None
    margin: Floats | None
    run_s: float
    compile_s: float = 0.0
    message: str = ""
    detail: Mapping[str, Any] = field(default_factory=dict)
    arrays: Mapping[str, Floats] = field(default_factory=dict)

    def fit(self, engine: str, inside: Bools) -> EngineResult:
        """This result, as the answer of ``engine`` on the cells ``inside`` (ny, nx) the corridor.

        Raises ``UnfitResult`` where it is no answer: a code of no kind, a region of a failure, none of a success,
        another shape or type, or cells outside the corridor.
        """
        wrong = self._unfit(inside)
        if wrong:
            raise UnfitResult(f"engine {engine}: {wrong}")
        return self

    def _unfit(self, inside: Bools) -> str:
        if not isinstance(self.code, ResultCode):
            return f"code: required a ResultCode, received {self.code!r}"
        if self.code is not ResultCode.OK:
            return "" if self.mask is None else f"mask: required none with {self.code.value}, received one"
        wrong = _unlike(inside, "mask", self.mask, np.bool_)
        if self.margin is not None:
            wrong = wrong or _unlike(inside, "margin", self.margin, np.floating)
        if wrong or self.mask is None:
            return wrong
        stray = int(np.count_nonzero(self.mask & ~inside))
        return f"mask: required cells inside the corridor, received {stray} outside" if stray else ""


def _unlike(inside: Bools, name: str, found: object, kind: type[np.generic]) -> str:
    """What is wrong about an array that should have a value of this kind for each cell."""
    if isinstance(found, np.ndarray) and found.shape == inside.shape and np.issubdtype(found.dtype, kind):
        return ""
    came = f"{found.dtype}, {found.shape}" if isinstance(found, np.ndarray) else type(found).__name__
    return f"{name}: required {kind.__name__}, {inside.shape}, received {came}"


class Engine(Protocol):
    """A reachability engine, made with its options or with their defaults; its spec has its name."""

    def solve(self, problem: Problem, context: Context) -> EngineResult:
        """Decide every cell; bad input raises ``InvalidInput``, a numerical failure gives a result code."""
        ...

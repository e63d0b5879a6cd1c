"""Settings of the Hamilton-Jacobi engine: what a request may say, checked before anything is computed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from safestart.engines.base import Problem
from safestart.engines.hj.frame import Frame
from safestart.errors import invalid
from safestart.model.scenario import Rest, SetKind, number

ENGINE = "hamilton_jacobi"

Shape = tuple[int, int, int, int]

ACCURACIES = ("low", "medium", "high", "very_high")
BOUNDARIES = ("edge", "extrapolate_away_from_zero")
SOLVERS = ("fused", "hj_reachability")
PRECISIONS = ("float32", "float64")
FRAMES = ("auto", *(frame.value for frame in Frame))
DEFAULT_SHAPE: Shape = (41, 41, 15, 15)
MIN_NODES, MAX_NODES, MAX_TOTAL_NODES = 5, 101, 5_000_000

_PREFIX = f"options.{ENGINE}"


@dataclass(frozen=True, slots=True)
class Settings:
    """Checked settings.

    ``solver`` is ours (``fused``, :mod:`safestart.levelset`) or ``hj_reachability``; both run the same schemes, the
    latter in ``precision`` float32 only. ``accuracy`` names the scheme as hj-reachability does: low (first order,
    Euler), medium (ENO2, RK2), high (WENO3, RK3), very_high (WENO5, RK3). ``shape`` counts the nodes of
    (x, y, vx, vy). ``domain`` holds explicit half widths (x m, y m, v m/s), None to size it from the problem.
    ``boundary`` pads the grid: ``edge`` repeats the last value, ``extrapolate_away_from_zero`` is the library's own
    default, kept for comparison. ``frame`` is the frame of the state and of ``domain``; asked for as ``auto`` it is
    LVLH, but for tubes of starts at rest in the body frame; ``body`` is the paper's. ``match`` makes the target
    velocity-aware: the corridor counts only where the velocity differs from co-rotation by at most that many m/s (None:
    any velocity).
    """

    accuracy: str = "low"
    shape: Shape = DEFAULT_SHAPE
    domain: tuple[float, float, float] | None = None
    boundary: str = "edge"
    frame: Frame = Frame.LVLH
    match: float | None = None
    solver: str = "fused"
    precision: str = "float32"

    @classmethod
    def of(cls, problem: Problem) -> Settings:
        """Settings from ``problem.options["hamilton_jacobi"]``; ``InvalidInput`` on anything unknown."""
        known = ("accuracy", "shape", "domain", "boundary", "frame", "match", "solver", "precision")
        problem.check_options(ENGINE, known)
        solver = _one_of("solver", problem.option(ENGINE, "solver", "fused"), SOLVERS)
        precisions = PRECISIONS if solver == "fused" else PRECISIONS[:1]
        return cls(
            _one_of("accuracy", problem.option(ENGINE, "accuracy", "low"), ACCURACIES),
            _shape(problem.option(ENGINE, "shape", DEFAULT_SHAPE)),
            _domain(problem.option(ENGINE, "domain", None)),
            _one_of("boundary", problem.option(ENGINE, "boundary", "edge"), BOUNDARIES),
            _frame(problem),
            _match(problem.option(ENGINE, "match", None)),
            solver,
            _one_of("precision", problem.option(ENGINE, "precision", "float32"), precisions),
        )


def _one_of(name: str, value: Any, known: tuple[str, ...]) -> str:
    if not isinstance(value, str) or value not in known:
        raise invalid(f"{_PREFIX}.{name}", f"one of {', '.join(known)}", value)
    return value


def _frame(problem: Problem) -> Frame:
    asked = _one_of("frame", problem.option(ENGINE, "frame", "auto"), FRAMES)
    if asked == "auto":
        # Measured: only there does the body frame come closer to the exact set (docs/theory/hamilton-jacobi.md).
        corotating_tube = problem.rest is Rest.BODY and problem.kind is SetKind.TUBE
        return Frame.BODY if corotating_tube else Frame.LVLH
    return Frame(asked)


def _match(value: Any) -> float | None:
    return None if value is None else number(f"{_PREFIX}.match", value, 0.0, 1e3, open_low=True)


def _shape(value: Any) -> Shape:
    required = (
        f"four integers in [{MIN_NODES}, {MAX_NODES}] (x, y, vx, vy), at most {MAX_TOTAL_NODES} nodes in all"
    )
    field = f"{_PREFIX}.shape"
    if not isinstance(value, list | tuple) or len(value) != 4:
        raise invalid(field, required, value)
    total = 1
    for count in value:
        if isinstance(count, bool) or not isinstance(count, int) or not MIN_NODES <= count <= MAX_NODES:
            raise invalid(field, required, value)
        total *= count
    if total > MAX_TOTAL_NODES:
        raise invalid(field, required, f"{list(value)} with {total} nodes")
    nx, ny, nvx, nvy = value
    return nx, ny, nvx, nvy


def _domain(value: Any) -> tuple[float, float, float] | None:
    if value is None:
        return None
    keys = ("x_m", "y_m", "v_m_s")
    if not isinstance(value, Mapping) or set(value) != set(keys):
        raise invalid(f"{_PREFIX}.domain", f"half widths {', '.join(keys)}", value)
    x, y, v = (number(f"{_PREFIX}.domain.{key}", value[key], 1e-3, 1e6) for key in keys)
    return x, y, v

"""Hamilton-Jacobi reachability on a grid (paper 000, eq. 11), with our own solver or with hj-reachability.

V(x, -T) is the least signed distance to the corridor that thrust can reach from x: at time T (fixed), or at some time
up to T (tube). The set of starts is {V <= 0} on the slice of states at rest.
"""

from __future__ import annotations

import math
import time
from typing import Any, Protocol

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from safestart.engines.base import EngineResult, Problem, ResultCode
from safestart.engines.hj.certified import count_errors, exact_answer
from safestart.engines.hj.domain import Domain, count_steps, size_domain, start_states, warnings
from safestart.engines.hj.frame import MODEL
from safestart.engines.hj.options import HamiltonJacobiInput
from safestart.engines.hj.settings import BOUNDARY, PRECISION, Settings
from safestart.engines.hj.target import TargetValues, target_at
from safestart.engines.region import restrict
from safestart.errors import Unavailable
from safestart.model.scenario import Floats, SetKind, number
from safestart.runtime.progress import Context

# Work between two polls of the context: a twentieth of the steps, and at most a few seconds.
MIN_STRETCHES, NODE_STEPS = 20, 20_000_000
# Share of the target function's range by which the value may leave it: rounding for the monotone first-order
# scheme, over- and undershoot (measured: 1 %) for the others. A faulty boundary makes the value leave it several times
# over.
MONOTONE_TOLERANCE, TOLERANCE = 1e-3, 0.05


class Solver(Protocol):
    """A time loop, ours or the library's."""

    compile_s: float

    def advance(self, span: float) -> tuple[bool, float, float]:
        """Step ``span`` seconds back; returns whether all values are finite, and the least and largest value."""
        ...

    def value(self) -> Floats:
        """The value function in float64."""
        ...


class HamiltonJacobi:
    """Level sets on a four-dimensional grid: neither an inner nor an outer bound, because the error has no sign."""

    def __init__(self, options: HamiltonJacobiInput | None = None, *, match: float | None = None) -> None:
        """``match`` (m/s, at most 1000) also requires co-rotation within that speed; raises ``InvalidInput``."""
        self._options = options or HamiltonJacobiInput()
        self._match = None if match is None else number("match", match, 0.0, 1e3, open_low=True)

    def solve(self, problem: Problem, context: Context) -> EngineResult:
        """Step the value function back over the horizon and read its slice at the starts.

        ``arrays`` holds ``margin_unrestricted`` (ny, nx), minus the value at the starts, before the restriction to the
        corridor, and ``margin_exact`` (ny, nx), the margin by support functions (of the position-only target).
        ``detail["certified"]`` counts the cells that the exact set refutes (:mod:`safestart.engines.hj.certified`); the
        mask is the level set's own.

        Raises ``InvalidInput`` for a grid that needs too many time steps, and ``Cancelled`` between stretches of time.
        A value that is not finite, or that leaves its possible range, is ``NUMERICAL_FAILURE``.
        """
        settings = Settings.of(problem, self._options, self._match)
        domain = size_domain(problem, settings.frame)
        steps, courant = count_steps(problem, domain, settings)
        context.step(0.0, problem.horizon, "compiling")
        target = TargetValues.of(problem, domain, settings)
        solver = _solver(problem, domain, settings, target.terminal, courant)
        detail = _detail(problem, domain, settings, steps, target)

        begin = time.perf_counter()
        failure = _march(problem, settings, solver, target, steps, context)
        value = solver.value()
        if not failure and problem.kind is SetKind.TUBE:
            excess = float((value - target.first).max())
            if excess > _slack(settings, target):
                failure = f"the tube's value exceeds the target function by {excess:.4g} m"
        if failure:
            run = time.perf_counter() - begin
            code = ResultCode.NUMERICAL_FAILURE
            return EngineResult(code, None, None, run, solver.compile_s, failure, detail)
        field = -_slice(problem, domain, settings, value)
        mask, margin = restrict(problem, field)
        run = time.perf_counter() - begin
        message = "; ".join(detail["warnings"])
        exact = exact_answer(problem, context)
        detail["certified"] = count_errors(problem, settings, field, exact)
        arrays = {"margin_unrestricted": field}
        if exact.code is ResultCode.OK:
            arrays["margin_exact"] = exact.arrays["margin_unrestricted"]
        detail["value_min_m"], detail["value_max_m"] = float(value.min()), float(value.max())
        return EngineResult(ResultCode.OK, mask, margin, run, solver.compile_s, message, detail, arrays)


def _solver(problem: Problem, domain: Domain, settings: Settings, terminal: Floats, courant: float) -> Solver:
    # JAX takes seconds to import; only its own solver needs it.
    if settings.solver == "fused":
        from safestart.engines.hj.fused import FusedSolver

        return FusedSolver(problem, domain, settings, terminal, courant)
    try:
        from safestart.engines.hj.peer import PeerSolver
    except ModuleNotFoundError as error:
        raise Unavailable(
            f"solver hj_reachability: required the extra safestart[oracle] on the worker, received no {error.name}",
            field="hamilton_jacobi.solver",
            required="the extra safestart[oracle], or solver fused",
            received="hj_reachability",
        ) from None
    return PeerSolver(problem, domain, settings, terminal, courant)


def _slack(settings: Settings, target: TargetValues) -> float:
    share = MONOTONE_TOLERANCE if settings.accuracy == "low" else TOLERANCE
    return share * (target.high - target.low)


def _march(
    problem: Problem, settings: Settings, solver: Solver, target: TargetValues, steps: int, context: Context
) -> str:
    """Run the horizon in equal stretches; returns the reason of a numerical failure, or "".

    The value is a minimum of l over states of the grid, so it must stay within l's range.
    """
    batch = min(math.ceil(steps / MIN_STRETCHES), max(1, NODE_STEPS // target.terminal.size))
    stretches = math.ceil(steps / batch)
    low, high, slack = target.low, target.high, _slack(settings, target)
    for k in range(stretches):
        finite, least, largest = solver.advance(problem.horizon / stretches)
        done = problem.horizon * (k + 1) / stretches
        if not finite:
            return f"the value is not finite after {done:g} s"
        if least < low - slack or largest > high + slack:
            return (
                f"after {done:g} s the value lies in [{least:.4g}, {largest:.4g}] m, outside the range "
                f"[{low:.4g}, {high:.4g}] m of the target function on the grid: the boundary has poisoned it"
            )
        context.step(done, problem.horizon)
    return ""


def _slice(problem: Problem, domain: Domain, settings: Settings, value: Floats) -> Floats:
    """V at the starts (ny, nx), multilinear between nodes; a start outside the box raises, it never gives NaN.

    A tube's value is at most l at the start itself, which is known exactly; the interpolated value can exceed it near
    the corridor's apex, which is finer than the grid.
    """
    states = start_states(problem, settings.frame)
    axes = domain.axes(settings.shape)
    found: Floats = RegularGridInterpolator(axes, value, bounds_error=True)(states)
    if problem.kind is SetKind.TUBE:
        found = np.minimum(found, target_at(problem, settings, states))
    return found


def _detail(
    problem: Problem, domain: Domain, settings: Settings, steps: int, target: TargetValues
) -> dict[str, Any]:
    """The settings that determine the answer, JSON-able."""
    return {
        "set": problem.kind.value,
        "rest": problem.rest.value,
        "frame": settings.frame.value,
        "accuracy": settings.accuracy,
        "boundary": BOUNDARY,
        "match_m_s": settings.match,
        "shape": list(settings.shape),
        "half_widths": {
            "x_m": float(domain.half[0]),
            "y_m": float(domain.half[1]),
            "v_m_s": float(domain.half[2]),
        },
        "spacing": [float(h) for h in domain.spacing(settings.shape)],
        "time_steps": steps,
        "target_min_m": target.low,
        "target_max_m": target.high,
        "solver": settings.solver,
        "precision": PRECISION,
        "model": MODEL[settings.frame],
        "warnings": warnings(problem, domain, settings),
    }

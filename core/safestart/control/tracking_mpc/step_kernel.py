"""The assembled program of one control step, compiled: its solution, and without one the least violation.

Soft rows may be violated by ``give`` times a common measure t >= 0, in metres. The least t comes from proofs of
infeasibility: a proof y gives t >= -y'bounds / y'give, the program is solved at that t, and so on (Dinkelbach). Every
round ends at another vertex of the dual, so a handful of rounds is enough. Then the cost is minimised at that t.
"""

from __future__ import annotations

import numpy as np

from safestart.control.tracking_mpc.active_set import INFEASIBLE, SOLVED, inverse_factor, minimise
from safestart.runtime.kernels.compiled import compiled

NOT_CONVEX = 3
_ROUNDS = 60
_SLACK = 1e-9
"""Added to the least t, m, so that rounding does not make the last program infeasible."""


@compiled(error_model="numpy", fastmath={"contract", "reassoc", "nsz"})
def moved_bounds(shift, state, low, high, lower, upper):  # type: ignore[no-untyped-def]
    """Bounds (R,) on rows' z for a start ``state`` (6,)."""
    for r in range(len(low)):
        value = 0.0
        for k in range(6):
            value += shift[k, r] * state[k]
        lower[r], upper[r] = low[r] - value, high[r] - value


@compiled(error_model="numpy")
def solve_from(rows, shift, hessian, slope, low, high, state, z, dual):  # type: ignore[no-untyped-def]
    """The hard program for one start; returns (status, steps)."""
    n, count = rows.shape
    factor, gradient = np.empty((n, n)), np.zeros(n)
    lower, upper = np.empty(count), np.empty(count)
    if not inverse_factor(hessian, factor):
        return NOT_CONVEX, 0
    for i in range(n):
        for k in range(6):
            gradient[i] += slope[i, k] * state[k]
    moved_bounds(shift, state, low, high, lower, upper)
    return minimise(factor, gradient, rows, lower, upper, z, dual)


@compiled(error_model="numpy")
def soften(rows, shift, hessian, slope, low, high, give, state, z, dual):  # type: ignore[no-untyped-def]
    """Least violation t, then cost; returns (status, t). INFEASIBLE: the hard rows alone contradict each other."""
    count = rows.shape[1]
    violation = 0.0
    wider_low, wider_high = low.copy(), high.copy()
    shifted_low, shifted_high = np.empty(count), np.empty(count)
    moved_bounds(shift, state, low, high, shifted_low, shifted_high)
    for _ in range(_ROUNDS):
        status, _steps = solve_from(rows, shift, hessian, slope, wider_low, wider_high, state, z, dual)
        if status != INFEASIBLE:
            return status, violation
        value, weight = 0.0, 0.0
        for r in range(count):
            if dual[r] > 0.0:
                value += dual[r] * shifted_high[r]
                weight += dual[r] * give[r]
            elif dual[r] < 0.0:
                value += dual[r] * shifted_low[r]
                weight -= dual[r] * give[r]
        if weight <= 0.0:
            return INFEASIBLE, violation
        violation = max(violation, -value / weight) + _SLACK
        for r in range(count):
            if give[r] > 0.0:
                wider_low[r], wider_high[r] = low[r] - give[r] * violation, high[r] + give[r] * violation
    return INFEASIBLE, violation


@compiled(error_model="numpy")
def feasible_starts(rows, shift, hessian, slope, low, high, starts):  # type: ignore[no-untyped-def]
    """Status (S,) of every start (S, 6) of one assembled program."""
    out = np.empty(len(starts), np.int64)
    z, dual = np.empty(len(rows)), np.empty(rows.shape[1])
    for s in range(len(starts)):
        out[s] = solve_from(rows, shift, hessian, slope, low, high, starts[s], z, dual)[0]
    return out


__all__ = ["INFEASIBLE", "NOT_CONVEX", "SOLVED", "feasible_starts", "soften", "solve_from"]

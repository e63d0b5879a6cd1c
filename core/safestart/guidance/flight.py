"""The closed loop: nominal command, safety filter and exact CWH truth, with no blending or projection of the state."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from safestart.errors import invalid
from safestart.guidance import plan as _plan
from safestart.guidance import regimes as _regimes
from safestart.guidance import safety_filter as _safety_filter
from safestart.guidance.plan import SUBSTEPS, Plan
from safestart.guidance.stamp import source_stamp
from safestart.scenario import Floats

_nominal = _regimes.nominal_command
_filter = _safety_filter.filter_step


@dataclass(frozen=True, slots=True)
class Flights:
    """Outcome of M flights.

    ``margin`` (M,): least distance to a face over the sub-steps flown, metres; a flight ends at its first
    violation, so a negative margin is the distance by which it was first seen outside. ``steps`` (M,): control
    steps begun.
    ``infeasible`` (M,): steps at which (7) was infeasible. ``delta_v`` (M,): m/s spent. ``peak`` (M,): largest thrust
    acceleration, m/s^2. ``finite`` (M,): False where the state left the floating-point numbers.
    """

    margin: Floats
    steps: np.ndarray[tuple[int], np.dtype[np.int64]]
    infeasible: np.ndarray[tuple[int], np.dtype[np.int64]]
    delta_v: Floats
    peak: Floats
    finite: np.ndarray[tuple[int], np.dtype[np.bool_]]

    @property
    def safe(self) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """True where no sub-step lay outside the corridor, (M,)."""
        return self.finite & (self.margin >= 0.0)


def _build(stamp: int):  # type: ignore[no-untyped-def]
    @njit(cache=True, nogil=True, error_model="numpy")
    def roll_out(plan, starts, counts, sums, log_state, log_command, log_code):  # type: ignore[no-untyped-def]
        stamp  # noqa: B018  (the cell is part of numba's cache key)
        law = plan.law
        horizon, d, m = plan.normals.shape
        phi, gamma = plan.transition, plan.input
        count = len(plan.offsets)
        logging = len(log_state) > 0
        bounds, work, index = np.empty(m), np.empty((10, 4)), np.empty(4, np.int64)
        nominal = np.zeros(3)
        command = np.zeros(3)
        previous = np.zeros(3)
        x = np.empty(6)
        for flight in range(len(starts)):
            x[:] = starts[flight]
            previous[:] = 0.0
            r0 = math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
            v_max = plan.closing_factor * math.sqrt(law.max_acceleration * r0)
            # At the start the body frame coincides with LVLH.
            margin = _distance(plan.start_faces, plan.offsets, x, d, count)
            steps, infeasible = 0, 0
            delta_v, peak = 0.0, 0.0
            finite = math.isfinite(x[0] + x[1] + x[2] + x[3] + x[4] + x[5])
            while steps < horizon and margin >= 0.0 and finite:
                k = steps
                steps += 1
                nominal[0], nominal[1], nominal[2], regime = _nominal(
                    x[0], x[1], x[2], x[3], x[4], x[5],
                    k * plan.dt, plan.rotation[k, 0], plan.rotation[k, 1], r0, v_max, law,
                )  # fmt: skip
                feasible = _filter(plan, k, x, nominal, previous, command, bounds, work, index)
                if not feasible:
                    infeasible += 1
                ux, uy, uz = command[0], command[1], command[2]
                size = math.sqrt(ux * ux + uy * uy + uz * uz)
                delta_v += size * plan.dt
                peak = max(peak, size)
                previous[0], previous[1], previous[2] = ux, uy, uz
                if logging:
                    log_command[k, 0], log_command[k, 1], log_command[k, 2] = ux, uy, uz
                    log_code[k, 0], log_code[k, 1] = regime, feasible
                for s in range(SUBSTEPS):
                    # Exact CWH over a sub-step; Phi couples (x, y) and leaves z alone.
                    a, b, c, p, q, w = x[0], x[1], x[2], x[3], x[4], x[5]
                    for i in (0, 1, 3, 4):
                        x[i] = (
                            phi[i, 0] * a + phi[i, 1] * b + phi[i, 3] * p + phi[i, 4] * q
                            + gamma[i, 0] * ux + gamma[i, 1] * uy
                        )  # fmt: skip
                    x[2] = phi[2, 2] * c + phi[2, 5] * w + gamma[2, 2] * uz
                    x[5] = phi[5, 2] * c + phi[5, 5] * w + gamma[5, 2] * uz
                    if logging:
                        log_state[k * SUBSTEPS + s, :] = x
                    distance = _distance(plan.faces[k, s], plan.offsets, x, d, count)
                    finite = math.isfinite(distance)
                    margin = min(margin, distance)
                    if margin < 0.0 or not finite:
                        break
            counts[flight, 0], counts[flight, 1], counts[flight, 2] = steps, infeasible, finite
            sums[flight, 0], sums[flight, 1], sums[flight, 2] = margin, delta_v, peak

    return roll_out


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _distance(normals, offsets, x, d, count):  # type: ignore[no-untyped-def]
    """Least distance (m) of the position in x to the faces with unit normals (d, F) and offsets (F,)."""
    least = math.inf
    for i in range(count):
        value = offsets[i]
        for c in range(d):
            value -= normals[c, i] * x[c]
        # Written so that a NaN distance is passed on, not skipped.
        if not value >= least:
            least = value
    return least


roll_out = _build(source_stamp(_plan, _regimes, _safety_filter, *_safety_filter.SOURCES))
"""The compiled loop; see :func:`fly` and :func:`safestart.guidance.trajectory.fly_start` for its arguments."""

_NO_LOG = (np.empty((0, 6)), np.empty((0, 3)), np.empty((0, 2), np.int64))


def fly(plan: Plan, starts: Floats) -> Flights:
    """Fly each of ``starts`` (M, 6), LVLH states (m, m/s) at t = 0, to the plan's end or its first violation.

    In a planar plan z and vz must be 0. Raises ``InvalidInput`` for another shape or a start out of the plane.
    """
    if starts.ndim != 2 or starts.shape[1] != 6:
        raise invalid("starts", "an array of shape (M, 6)", starts.shape)
    if plan.normals.shape[1] == 2 and starts[:, [2, 5]].any():
        raise invalid("starts", "z = 0 and vz = 0 in a planar plan", "a start out of the plane")
    counts = np.empty((len(starts), 3), np.int64)
    sums = np.empty((len(starts), 3))
    roll_out(plan, np.ascontiguousarray(starts, dtype=np.float64), counts, sums, *_NO_LOG)
    return Flights(
        sums[:, 0], counts[:, 0], counts[:, 1], sums[:, 1], sums[:, 2], counts[:, 2].astype(np.bool_)
    )

"""The closed loop: nominal command, safety filter and exact CWH truth, with no blending or projection of the state."""

from __future__ import annotations

import math

import numpy as np

from safestart.control import regimes as _regimes
from safestart.control import safety_filter as _safety_filter
from safestart.control.controller import Command
from safestart.control.forecast import Plan
from safestart.control.regimes import REGIMES
from safestart.errors import invalid
from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled
from safestart.simulation import noise as _noise
from safestart.simulation import passage as _passage
from safestart.simulation.noise import CONTINUOUS, DRAWS, NO_DRAWS, Truth
from safestart.simulation.record import Counts, Path, Record

_nominal = _regimes.nominal_command
_filter = _safety_filter.filter_step
_distance, _slopes, _advance = _passage.distance, _passage.slopes, _passage.advance
_delivered = _noise.delivered
_CONTINUOUS = CONTINUOUS


@compiled(error_model="numpy")
def roll_out(plan, truth, draws, starts, counts, sums, log_state, log_command, log_code):  # type: ignore[no-untyped-def]
    """The compiled loop; :func:`fly` explains its arguments."""
    law = plan.law
    horizon, d, m = plan.normals.shape
    count = len(plan.offsets)
    step = plan.dt / plan.faces.shape[1]
    logging = len(log_state) > 0
    drawing = len(draws) > 0
    bounds, work, index = np.empty(m), np.empty((10, 4)), np.empty(4, np.int64)
    nominal, command, previous = np.empty(3), np.empty(3), np.empty(3)
    before, after = np.empty((2, count)), np.empty((2, count))
    x, seen = np.empty(6), np.empty(6)
    for flight in range(len(starts)):
        for i in range(6):
            x[i] = starts[flight, i]
        for i in range(3):
            previous[i], command[i] = 0.0, 0.0
        r0 = math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
        v_max = plan.closing_factor * math.sqrt(law.max_acceleration * r0)
        # At the start the body frame coincides with LVLH.
        margin = _distance(plan.start_faces, plan.offsets, x, d, count)
        if truth.check == _CONTINUOUS:
            _slopes(plan.start_faces, plan.offsets, x, d, count, law.tumble_rate, step, before)
        steps, infeasible = 0, 0
        delta_v, peak = 0.0, 0.0
        violated_at = math.inf if margin >= 0.0 else 0.0
        finite = math.isfinite(x[0] + x[1] + x[2] + x[3] + x[4] + x[5])
        while steps < horizon and margin >= 0.0 and finite:
            k = steps
            steps += 1
            for i in range(6):
                seen[i] = x[i]
            if drawing:
                seen[0] += truth.position_sigma * draws[flight, k, 0]
                seen[1] += truth.position_sigma * draws[flight, k, 1]
                seen[3] += truth.velocity_sigma * draws[flight, k, 2]
                seen[4] += truth.velocity_sigma * draws[flight, k, 3]
            nominal[0], nominal[1], nominal[2], regime = _nominal(
                seen[0], seen[1], seen[2], seen[3], seen[4], seen[5],
                k * plan.dt, plan.rotation[k, 0], plan.rotation[k, 1], r0, v_max, law,
            )  # fmt: skip
            feasible = _filter(plan, k, seen, nominal, previous, command, bounds, work, index)
            if not feasible:
                infeasible += 1
            ux, uy, uz = command[0], command[1], command[2]
            previous[0], previous[1], previous[2] = ux, uy, uz
            if drawing:
                ux, uy = _delivered(truth, ux, uy, draws[flight, k, 4], draws[flight, k, 5])
            size = math.sqrt(ux * ux + uy * uy + uz * uz)
            if size * plan.dt < truth.minimum_impulse:
                ux, uy, uz, size = 0.0, 0.0, 0.0, 0.0
            delta_v += size * plan.dt
            peak = max(peak, size)
            if logging:
                log_command[k, 0], log_command[k, 1], log_command[k, 2] = ux, uy, uz
                log_code[k, 0], log_code[k, 1] = regime, feasible
            least, late = _advance(
                k, x, ux, uy, uz, plan.transition, plan.input, plan.faces, plan.offsets,
                law.tumble_rate, step, truth.check, before, after, log_state,
            )  # fmt: skip
            finite = math.isfinite(least)
            margin = min(margin, least)
            if late < math.inf:
                violated_at = k * plan.dt + late
        counts[flight, 0], counts[flight, 1], counts[flight, 2] = steps, infeasible, finite
        sums[flight, 0], sums[flight, 1], sums[flight, 2] = margin, delta_v, peak
        sums[flight, 3] = violated_at


_NO_LOG = (np.empty((0, 6)), np.empty((0, 3)), np.empty((0, 2), np.int64))
SUB_STEPPED = Truth()


def fly(
    plan: Plan,
    starts: Floats,
    truth: Truth = SUB_STEPPED,
    draws: Floats = NO_DRAWS,
    *,
    keep_paths: bool = False,
) -> Record:
    """Fly each of ``starts`` (M, 6), LVLH states (m, m/s) at t = 0, to the plan's end or its first violation.

    In a planar plan z and vz must be 0. ``draws`` (M, K, 6) are the standard normals of :func:`noise.draws`, needed if
    ``truth`` is noisy. ``keep_paths`` records every checked instant. Raises ``InvalidInput`` for other shapes, a start
    out of the plane, and noise in space.
    """
    _check(plan, starts, truth, draws)
    starts = np.ascontiguousarray(starts, dtype=np.float64)
    counts, sums = np.empty((len(starts), 3), np.int64), np.empty((len(starts), 4))
    paths: list[Path] = []
    if keep_paths:
        for row in range(len(starts)):
            one = slice(row, row + 1)
            paths.append(_logged(plan, truth, draws[one], starts[one], counts[one], sums[one]))
    else:
        roll_out(plan, truth, draws, starts, counts, sums, *_NO_LOG)
    margin = np.where(counts[:, 2] != 0, sums[:, 0], np.nan)
    return Record(margin, sums[:, 3], sums[:, 1], sums[:, 2], counts[:, 0], counts[:, 1], tuple(paths))


def _logged(plan: Plan, truth: Truth, draws: Floats, start: Floats, counts: Counts, sums: Floats) -> Path:
    """Fly one ``start`` (1, 6) into ``counts`` (1, 3) and ``sums`` (1, 4)."""
    steps, substeps = plan.faces.shape[:2]
    states = np.full((steps * substeps, 6), np.nan)
    thrust, codes = np.empty((steps, 3)), np.empty((steps, 2), np.int64)
    roll_out(plan, truth, draws, start, counts, sums, states, thrust, codes)
    flown = int(counts[0, 0])
    states = np.concatenate([start, states[~np.isnan(states[:, 0])]])
    times: Floats = np.arange(len(states), dtype=np.float64) * (plan.dt / substeps)
    commands = tuple(
        Command(held, bool(feasible), REGIMES[regime])
        for held, (regime, feasible) in zip(thrust[:flown], codes[:flown].tolist(), strict=True)
    )
    return Path(times, states, thrust[:flown], commands)


def _check(plan: Plan, starts: Floats, truth: Truth, draws: Floats) -> None:
    if starts.ndim != 2 or starts.shape[1] != 6:
        raise invalid("starts", "an array of shape (M, 6)", starts.shape)
    planar = plan.normals.shape[1] == 2
    if planar and starts[:, [2, 5]].any():
        raise invalid("starts", "z = 0 and vz = 0 in a planar plan", "a start out of the plane")
    wanted = (len(starts), len(plan.normals), DRAWS) if truth.noisy else NO_DRAWS.shape
    if draws.shape != wanted or (truth.noisy and not planar):
        raise invalid("draws", f"shape {wanted} in a planar plan", draws.shape)

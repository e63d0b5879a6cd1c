"""The cutting planes of one `stay` question in the CWH motion, without a step of Python between its rounds.

The twin of this kernel is :class:`safestart.exact.search.Search`, which does the same for every other question.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from safestart.exact.answer import GUARD, TOLERANCE
from safestart.exact.kernels.minima import below_cubics, derivative_bounds, flight_minima, local_minima
from safestart.exact.kernels.rows import face_rows
from safestart.exact.search import (
    DROPPING_ROUNDS,
    FAR,
    FINEST,
    FIRST_GUESS,
    MOST_ROUNDS,
    NARROW,
    NO_WEIGHT,
    SAME_S,
    SOME_WEIGHT,
    TOUCH_STEPS,
)
from safestart.optim.ball_margin import CLOSE, SOLVED, largest_margin
from safestart.optim.largest_margin import COARSE_M, FINE_M, LEAST_WEIGHT
from safestart.optim.thrust_ball import INSIDE
from safestart.runtime.kernels.compiled import compiled


class Tables(NamedTuple):
    """What a watch holds for all starts: see :class:`safestart.exact.watch.Watch`, in SI."""

    free: Any
    pushed: Any
    along: Any
    held: Any
    cosine: Any
    sine: Any
    begins: Any
    normals: Any
    offsets: Any
    phase: float
    rate: float
    mean_motion: float
    dt: float
    step: float


_MOST_ROWS = 600
"""More rows than this are so alike that the method slows down: then Clarabel is quicker."""


@compiled()
def _into_balls(w: Any, a_max: float, d: int) -> Any:
    thrust = np.empty((len(w) // d, d))
    for k in range(len(thrust)):
        square = 0.0
        for i in range(d):
            square += w[d * k + i] * w[d * k + i]
        scale = INSIDE / max(math.sqrt(square), INSIDE)
        for i in range(d):
            thrust[k, i] = a_max * (w[d * k + i] * scale)
    return thrust


@compiled()
def _proved(constant: Any, rows: Any, weights: Any, d: int) -> float:
    """The bound of the weights, less the small ones, which are dropped here; the others' sum becomes 1."""
    largest, total = 1.0, 0.0
    for j in range(len(weights)):
        largest = max(largest, weights[j])
    for j in range(len(weights)):
        if weights[j] < LEAST_WEIGHT * largest:
            weights[j] = 0.0
        total += weights[j]
    level = 0.0
    pull = np.zeros(rows.shape[1])
    for j in range(len(weights)):
        weights[j] /= total
        level += weights[j] * constant[j]
        if weights[j] > 0.0:
            for i in range(len(pull)):
                pull[i] += weights[j] * rows[j, i]
    for k in range(len(pull) // d):
        square = 0.0
        for i in range(d * k, d * k + d):
            square += pull[i] * pull[i]
        level += math.sqrt(square)
    return level


@compiled()
def _touch(
    time: float, face: int, times: Any, faces: Any, load: Any, dips: Any, dt: float, horizon: float
) -> float:
    """Where the best flight may touch near a minimum; negative where there is no better guess than the minimum.

    ``dips`` (F, 2) holds for every face the last weighted time and distance to its minimum, NaN before.
    """
    total, carried = 0.0, 0.0
    for j in range(len(load)):
        if faces[j] == face and abs(times[j] - time) < TOUCH_STEPS * dt and load[j] > SOME_WEIGHT:
            total += load[j]
            carried += load[j] * times[j]
    if total == 0.0:
        return -1.0
    carried /= total
    dip, before_time, before = time - carried, dips[face, 0], dips[face, 1]
    dips[face, 0], dips[face, 1] = carried, dip
    touch = carried + FIRST_GUESS * dip
    if before * dip < 0.0:
        touch = carried + dip * (before_time - carried) / (dip - before)
    known = min(abs(touch - time), abs(dip)) <= SAME_S
    return -1.0 if known or not 0.0 < touch < horizon else touch


@compiled()
def _that_may_bind(state: Any, normals: Any, offsets: Any, constant: Any, reach: Any) -> Any:
    """Places of the first rows that may bind, and the distance (m) to the nearest face now.

    At t = 0 only the nearest face matters; a row that cannot fall below the best possible margin cannot bind.
    """
    nearest, distance = 0, math.inf
    for f in range(len(offsets)):
        here = 0.0
        for i in range(normals.shape[1]):
            here += normals[f, i] * state[i]
        if offsets[f] - here < distance:
            nearest, distance = f, offsets[f] - here
    places, count = np.empty(len(constant), np.int64), 0
    most = constant[nearest] + reach[nearest]
    for j in range(len(constant)):
        if j == nearest or (j >= len(offsets) and constant[j] - reach[j] < most):
            places[count] = j
            count += 1
    return places[:count], distance


@compiled()
def narrow(
    state: Any,
    tables: Any,
    first_times: Any,
    first_faces: Any,
    first_constant: Any,
    first_rows: Any,
    reach: Any,
    a_max: float,
    rounding: float,
    tolerance: float,
    verdict_only: bool,
) -> Any:
    """Bracket the margin of ``state`` (2 d,) from the first rows; :meth:`Search.narrow` says how.

    The first rows, those of all faces at t = 0 in front: times, faces, ``first_constant`` (J,), ``first_rows`` (J, N d)
    in m at full thrust, and how far thrust can move each. Returns whether every program was settled (no for a start
    outside), lower, upper (m), rounds, thrust (N, d), and times, faces and weights of the evidence for upper.
    """
    d, columns = tables.normals.shape[1], first_rows.shape[1]
    horizon = tables.dt * len(tables.free)
    lower, upper, rounds = -math.inf, math.inf, 0
    best = np.zeros((columns // d, d))
    known_times, known_faces, known_weights = np.empty(0), np.empty(0, np.int64), np.empty(0)
    dips = np.full((len(tables.offsets), 2), math.nan)
    places, distance = _that_may_bind(state, tables.normals, tables.offsets, first_constant, reach)
    if distance < -GUARD:
        return False, lower, upper, rounds, best, known_times, known_faces, known_weights
    times, faces, constant = first_times[places], first_faces[places], first_constant[places]
    rows = np.empty((len(places), columns))
    for j in range(len(places)):
        for i in range(columns):
            rows[j, i] = first_rows[places[j], i]
    fine = False
    while rounds < MOST_ROUNDS:
        rounds += 1
        w, load, status, _ = largest_margin(constant, rows, d, FINE_M if fine else COARSE_M)
        if status not in (SOLVED, CLOSE):
            return False, lower, upper, rounds, best, known_times, known_faces, known_weights
        bound = _proved(constant, rows, load, d)
        if bound + rounding < upper:
            upper = bound + rounding
            known_times, known_faces, known_weights = times, faces, load
        thrust = _into_balls(w, a_max, d)
        low, at, _, furthest, fastest, push = flight_minima(
            state,
            thrust,
            tables.free,
            tables.along,
            tables.held,
            tables.cosine,
            tables.sine,
            tables.normals,
            tables.offsets,
            tables.rate,
            tables.mean_motion,
            tables.step,
            0.0,
        )
        dip_times, dip_faces, dip_values = local_minima(low, at, tables.begins, tables.step)
        lowest, total = math.inf, 0.0
        for p in range(len(low)):
            for f in range(len(tables.offsets)):
                lowest = min(lowest, low[p, f])
                total += low[p, f]
        if not math.isfinite(total):
            return False, lower, upper, rounds, best, known_times, known_faces, known_weights
        bounds = derivative_bounds(tables.mean_motion, tables.step, furthest, fastest, push)
        lowest -= below_cubics(tables.rate, tables.step, bounds)
        if lowest - rounding > lower:
            lower, best = lowest - rounding, thrust
        decided = lower > GUARD or upper < -GUARD
        goal = tolerance if decided else FINEST
        fine = goal < TOLERANCE and upper - lower < NARROW
        if upper - lower <= goal or (decided and verdict_only):
            break
        # Cuts: the minima below the program's margin, then the guessed touches.
        new_times, new_faces, count = np.empty(2 * len(dip_times)), np.empty(2 * len(dip_times), np.int64), 0
        for k in range(len(dip_times)):
            if dip_values[k] < upper - 0.25 * goal:
                new_times[count], new_faces[count] = min(dip_times[k], horizon), dip_faces[k]
                count += 1
        if count == 0:
            break
        if len(load) > _MOST_ROWS:
            return False, lower, upper, rounds, best, known_times, known_faces, known_weights
        for k in range(count):
            touch = _touch(new_times[k], new_faces[k], times, faces, load, dips, tables.dt, horizon)
            if touch >= 0.0:
                new_times[count], new_faces[count] = touch, new_faces[k]
                count += 1
        start, cut = face_rows(
            new_times[:count],
            new_faces[:count],
            tables.normals,
            tables.phase,
            tables.rate,
            tables.mean_motion,
            tables.dt,
            tables.free,
            tables.pushed,
        )
        # The rows that stay, then the new ones.
        kept, most = np.empty(len(load), np.int64), 0
        far = upper + FAR * (upper - lowest)
        for j in range(len(load)):
            near = rounds > DROPPING_ROUNDS or load[j] > NO_WEIGHT
            if not near:
                distance = constant[j]
                for i in range(columns):
                    distance += rows[j, i] * thrust[i // d, i % d] / a_max
                near = distance < far
            if near:
                kept[most] = j
                most += 1
        old_times, old_faces, old_constant, old_rows = times, faces, constant, rows
        times, faces = np.empty(most + count), np.empty(most + count, np.int64)
        constant, rows = np.empty(most + count), np.empty((most + count, columns))
        for j in range(most):
            times[j], faces[j] = old_times[kept[j]], old_faces[kept[j]]
            constant[j] = old_constant[kept[j]]
            for i in range(columns):
                rows[j, i] = old_rows[kept[j], i]
        for j in range(count):
            times[most + j], faces[most + j] = new_times[j], new_faces[j]
            value = tables.offsets[new_faces[j]]
            for i in range(len(state)):
                value += start[j, i] * state[i]
            constant[most + j] = value
            for i in range(columns):
                rows[most + j, i] = a_max * cut[j, i]
    return True, lower, upper, rounds, best, known_times, known_faces, known_weights

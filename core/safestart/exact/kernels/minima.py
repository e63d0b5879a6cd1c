"""One flight's margins at all samples, the cubics between them, and their local minima in time.

The twin of this kernel, written with arrays, is in tests/unit/exact/test_kernels.py.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safestart.attitude.turn_kernel import into_body
from safestart.constraints.dip import dip
from safestart.runtime.kernels.compiled import compiled


@compiled()
def local_minima(low: Any, at: Any, begins: Any, length: float) -> Any:
    """Times, faces and values of the minima over time in ``low`` (P, F), ordered by time, then face.

    Sample p begins at ``begins[p]`` and lasts ``length`` s; ``at`` (P, F) are places in it, from 0 to 1.
    """
    samples, faces = low.shape
    count = 0
    for p in range(samples):
        for f in range(faces):
            here = low[p, f]
            if (p == 0 or here <= low[p - 1, f]) and (p == samples - 1 or here < low[p + 1, f]):
                count += 1
    times, of, values = np.empty(count), np.empty(count, np.int64), np.empty(count)
    count = 0
    for p in range(samples):
        for f in range(faces):
            here = low[p, f]
            if (p == 0 or here <= low[p - 1, f]) and (p == samples - 1 or here < low[p + 1, f]):
                times[count] = begins[p] + length * at[p, f]
                of[count], values[count] = f, here
                count += 1
    return times, of, values


@compiled()
def flight_minima(
    state: Any,
    thrust: Any,
    free: Any,
    along: Any,
    held: Any,
    cosine: Any,
    sine: Any,
    normals: Any,
    offsets: Any,
    rate: float,
    mean_motion: float,
    step: float,
    limit: float,
) -> Any:
    """Minima of all margins of a flight, and what bounds the margins between its samples.

    Tables as in :class:`~safestart.optim.prediction.Prediction` of a steady motion; ``cosine``, ``sine`` (N, S+1) of
    the turn, ``normals`` (F, d) unit in the body frame. With ``limit`` > 0 (m/s) column F is limit^2 - |v|^2, m^2/s^2.
    Returns minima (N S, columns), places in the samples (N S, columns), the last state (2 d,), the largest |r| (m),
    |v| (m/s) and |u| (m/s^2).
    """
    intervals, d = thrust.shape
    size, faces = 2 * d, len(offsets)
    parts = cosine.shape[1] - 1
    columns = faces + (1 if limit > 0.0 else 0)
    low, at = np.empty((intervals * parts, columns)), np.empty((intervals * parts, columns))
    value, slope = np.empty((2, columns)), np.empty((2, columns))
    driven, node, flown = np.zeros(size), np.empty(size), np.empty(size)
    furthest, fastest, hardest = 0.0, 0.0, 0.0
    for k in range(intervals):
        for i in range(size):
            total = driven[i]
            for j in range(size):
                total += free[k, i, j] * state[j]
            node[i] = total
        push = 0.0
        for j in range(d):
            push += thrust[k, j] * thrust[k, j]
        hardest = max(hardest, push)
        for s in range(parts + 1):
            now, before = s % 2, (s + 1) % 2
            for i in range(size):
                total = 0.0
                for j in range(size):
                    total += node[j] * along[j, s * size + i]
                for j in range(d):
                    total += thrust[k, j] * held[j, s * size + i]
                flown[i] = total
            far, fast = 0.0, 0.0
            for i in range(d):
                far += flown[i] * flown[i]
                fast += flown[d + i] * flown[d + i]
            furthest, fastest = max(furthest, far), max(fastest, fast)
            c, sn = cosine[k, s], sine[k, s]
            vx, vy = flown[d] + rate * flown[1], flown[d + 1] - rate * flown[0]
            x, y = into_body(c, sn, flown[0], flown[1])
            wx, wy = into_body(c, sn, vx, vy)
            for f in range(faces):
                place = normals[f, 0] * x + normals[f, 1] * y
                speed = normals[f, 0] * wx + normals[f, 1] * wy
                if d == 3:
                    place += normals[f, 2] * flown[2]
                    speed += normals[f, 2] * flown[5]
                value[now, f], slope[now, f] = offsets[f] - place, -step * speed
            if limit > 0.0:
                n = mean_motion
                ax = thrust[k, 0] + 3.0 * n * n * flown[0] + 2.0 * n * flown[d + 1]
                ay = thrust[k, 1] - 2.0 * n * flown[d]
                power = flown[d] * ax + flown[d + 1] * ay
                if d == 3:
                    power += flown[5] * (thrust[k, 2] - n * n * flown[2])
                value[now, faces], slope[now, faces] = limit * limit - fast, -2.0 * step * power
            if s > 0:
                p = k * parts + s - 1
                for f in range(columns):
                    low[p, f], at[p, f] = dip(
                        value[before, f], value[now, f], slope[before, f], slope[now, f]
                    )
        # The response to the thrusts alone, carried to the next node; the free part has a table of its own.
        for i in range(size):
            total = 0.0
            for j in range(size):
                total += driven[j] * along[j, parts * size + i]
            for j in range(d):
                total += thrust[k, j] * held[j, parts * size + i]
            node[i] = total
        for i in range(size):
            driven[i] = node[i]
    return low, at, flown, math.sqrt(furthest), math.sqrt(fastest), math.sqrt(hardest)


@compiled()
def derivative_bounds(mean_motion: float, step: float, furthest: float, fastest: float, push: float) -> Any:
    """Bounds between samples ``step`` s apart on |r| in LVLH (m) and its first four derivatives (SI), five numbers.

    ``furthest`` (m) and ``fastest`` (m/s) hold at the samples, ``push`` (m/s^2) for every thrust.
    """
    n, half = mean_motion, 0.5 * step
    # |a| <= 3 n^2 r + 2 n v + u, carried over half a sample from the nearer end.
    gain = half * (2.0 * n + 3.0 * n * n * half)
    if gain >= 1.0:
        return math.inf, math.inf, math.inf, math.inf, math.inf
    v = (fastest + half * (3.0 * n * n * furthest + push)) / (1.0 - gain)
    r = furthest + half * v
    a = 3.0 * n * n * r + 2.0 * n * v + push
    jerk = 3.0 * n * n * v + 2.0 * n * a
    return r, v, a, jerk, 3.0 * n * n * a + 2.0 * n * jerk


@compiled()
def below_cubics(rate: float, step: float, bounds: Any) -> float:
    """How far (m) a distance may lie below the cubics, h^4 max |f''''| / 384: Leibniz over the turn at ``rate``."""
    r, v, a, jerk, snap = bounds
    w = rate
    bent = w * w * w * w * r + 4.0 * w * w * w * v + 6.0 * w * w * a + 4.0 * w * jerk + snap
    below: float = bent * step * step * step * step / 384.0
    return below

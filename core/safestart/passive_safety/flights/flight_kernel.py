"""Compiled flights of single starts by fixed steps of an explicit Runge-Kutta method with a given tableau."""

from __future__ import annotations

import numpy as np

from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled


@compiled()
def _rates(z: Floats, gain: Floats, drift: Floats, out: Floats) -> None:
    """``drift``: 3n^2, 2n, mu, r; mu > 0 for Kepler's motion, else Clohessy-Wiltshire-Hill. ``gain``: K / m (2, 4)."""
    x, y, vx, vy = z
    out[0], out[1] = vx, vy
    if drift[2] > 0.0:
        rate, r = 0.5 * drift[1], drift[3]
        apart = (r + x) ** 2 + y**2
        pull = drift[2] / (apart * np.sqrt(apart))
        # mu/r^2 - mu (r + x)/r_c^3, without the cancellation of two large numbers.
        excess = (apart - r * r) / (r * r)
        share = 1.0 - 1.0 / ((1.0 + excess) * np.sqrt(1.0 + excess))
        out[2] = rate**2 * x + 2.0 * rate * vy + drift[2] / (r * r) * share - pull * x
        out[3] = rate**2 * y - 2.0 * rate * vx - pull * y
    else:
        out[2] = drift[0] * x + drift[1] * vy
        out[3] = -drift[1] * vx
    for j in range(4):
        out[2] -= gain[0, j] * z[j]
        out[3] -= gain[1, j] * z[j]


@compiled()
def _step(
    z: Floats, h: float, gain: Floats, drift: Floats, a: Floats, b: Floats, k: Floats, out: Floats
) -> None:
    """One step of length ``h``; ``k`` (stages + 1, 4) is scratch, ``out`` (4,) the new state."""
    stages = len(b)
    for s in range(stages):
        for i in range(4):
            total = 0.0
            for m in range(s):
                total += a[s, m] * k[m, i]
            k[stages, i] = z[i] + h * total
        _rates(k[stages], gain, drift, k[s])
    for i in range(4):
        total = 0.0
        for m in range(stages):
            total += b[m] * k[m, i]
        out[i] = z[i] + h * total


@compiled()
def _depth(z: Floats, faces: Floats, limits: Floats, circle: float) -> float:
    """Excess over the guard: a circle of radius ``circle`` if that is positive, else the faces."""
    if circle > 0.0:
        return float(np.sqrt(z[0] ** 2 + z[1] ** 2) - circle)
    most = -1e300
    for f in range(len(limits)):
        most = max(most, faces[f, 0] * z[0] + faces[f, 1] * z[1] - limits[f])
    return most


@compiled()
def fly(
    starts: Floats,
    aborts: Floats,
    times: Floats,
    gains: Floats,
    drift: Floats,
    faces: Floats,
    limits: Floats,
    circle: float,
    pace: Floats,
    a: Floats,
    b: Floats,
) -> tuple[Floats, Floats]:
    """States (N, T, 4) at ``times`` (N, T), ascending per row, of ``starts`` (N, 4); first entries (N,), inf: none.

    Engines fail at ``aborts`` (N,). ``gains`` (3, 2, 4): K / m of modes 1, 2 and passive. ``pace`` (3, 3) per mode:
    first step, its period of use, later step, min.
    """
    count, wanted = times.shape
    states = np.empty((count, wanted, 4))
    entries = np.full(count, np.inf)
    for n in range(count):
        k = np.empty((len(b) + 1, 4))
        z, new, trial = starts[n].copy(), np.empty(4), np.empty(4)
        t, since, mode, w = 0.0, 0.0, 0, 0
        while w < wanted:
            if mode < 2 and t >= aborts[n]:
                mode, since = 2, t
            while w < wanted and times[n, w] <= t:
                for i in range(4):
                    states[n, w, i] = z[i]
                w += 1
            if w == wanted:
                break
            h = pace[mode, 0] if t - since < pace[mode, 1] else pace[mode, 2]
            stop = times[n, w] if mode == 2 else min(times[n, w], aborts[n])
            reach = stop - t <= h
            if reach:
                h = stop - t
            _step(z, h, gains[mode], drift, a, b, k, new)
            if mode == 0 and _depth(new, faces, limits, circle) < 0.0:
                low, high = 0.0, h
                for _ in range(55):
                    middle = 0.5 * (low + high)
                    _step(z, middle, gains[0], drift, a, b, k, trial)
                    if _depth(trial, faces, limits, circle) < 0.0:
                        high = middle
                    else:
                        low = middle
                _step(z, high, gains[0], drift, a, b, k, new)
                t += high
                entries[n], mode, since = t, 1, t
            else:
                t = stop if reach else t + h
            for i in range(4):
                z[i] = new[i]
    return states, entries

"""Compiled kernel: signed margin between reachable set and rotating corridor, for many starts.

For a start p the reachable set at time t, in body axes, is q(t) + {displacements of support S}, with
q = R(-omega t) D(t) p. With the separating direction at angle a (see :mod:`safestart.sets`),

    f(t, a) = (q_x +- x0) sin a + (q_y - r_h) cos a + S(t, pi/2 - a + omega t)

and the margin is max over t of min over a. Every derivative is in closed form (the series is), so both
extrema are polished instead of sampled: Newton in ``a``, tangents in ``t``. One file holds the whole kernel.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.attitude.turn_kernel import into_body
from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled

FINE = 1e-8
"""Accuracy (m) sought for margins near zero, so that the sign is right."""
COARSE = 2e-5
"""Accuracy (m) sought for margins farther from zero than ``NEAR``."""
NEAR = 1e-2
BLOCK = 64
DRIFT = 4


@compiled(error_model="numpy")
def _collapse(series: Floats, x: float, out: Floats) -> None:
    """Chebyshev sum over the rows of ``series`` at x in [-1, 1], into ``out``."""
    before, now = 1.0, x
    for j in range(series.shape[1]):
        out[j] = series[0, j]
    for k in range(1, series.shape[0]):
        for j in range(series.shape[1]):
            out[j] += now * series[k, j]
        before, now = now, 2.0 * x * now - before


@compiled(error_model="numpy")
def _turn(raw: Floats, theta: float, out: Floats) -> None:
    """Fourier terms of S in the LVLH angle phi = pi/2 - a + theta, rewritten in a."""
    c1, s1 = -math.cos(2.0 * theta), -math.sin(2.0 * theta)
    c, s = c1, s1
    out[0] = raw[DRIFT]
    for k in range(1, out.shape[0], 2):
        a, b = raw[DRIFT + k], raw[DRIFT + k + 1]
        out[k], out[k + 1] = a * c + b * s, a * s - b * c
        c, s = c * c1 - s * s1, s * c1 + c * s1


@compiled(error_model="numpy")
def _f(a: float, x: float, y: float, waves: Floats) -> tuple[float, float, float, float, float]:
    """f, df/da, d2f/da2, and S and dS/da, at one angle of one smooth piece."""
    sine, cosine = math.sin(a), math.cos(a)
    c1, s1 = cosine * cosine - sine * sine, 2.0 * sine * cosine
    c, s = c1, s1
    v, d, dd = waves[0], 0.0, 0.0
    for k in range(1, waves.shape[0], 2):
        w = float(k + 1)
        even, odd = waves[k] * c + waves[k + 1] * s, waves[k + 1] * c - waves[k] * s
        v += even
        d += w * odd
        dd -= w * w * even
        c, s = c * c1 - s * s1, s * c1 + c * s1
    along = x * sine + y * cosine
    return along + v, x * cosine - y * sine + d, dd - along, v, d


@compiled(error_model="numpy")
def _polish(a: float, low: float, high: float, x: float, y: float, waves: Floats) -> float:
    """Angle of the local minimum of one smooth piece inside [low, high]: Newton, safeguarded by bisection."""
    for _ in range(60):
        _, d, dd, _, _ = _f(a, x, y, waves)
        # The remaining gain is about d^2 / (2 dd).
        if dd > 0.0 and d * d <= 1e-11 * dd:
            break
        if d > 0.0:
            high = a
        else:
            low = a
        if high - low <= 1e-12:
            break
        step = a - d / dd if dd > 0.0 else low
        a = step if low < step < high else 0.5 * (low + high)
    return a


@compiled(error_model="numpy")
def _least(
    qx: float, qy: float, half: float, nodes: Floats, scan: Floats, waves: Floats
) -> tuple[float, float]:
    """Least f over the arc and its angle: every local minimum of ``scan`` (f at the nodes) is polished."""
    last = nodes.shape[0] - 1
    middle = last // 2
    best, where = math.inf, 0.0
    for j in range(last + 1):
        if (j > 0 and scan[j - 1] < scan[j]) or (j < last and scan[j + 1] <= scan[j]):
            continue
        a = nodes[j]
        low, high = nodes[max(j - 1, 0)], nodes[min(j + 1, last)]
        side = half if j > middle else -half
        if j == middle:
            # The port's half-width puts a kink at a = 0: the minimum is there or in one of the two pieces.
            slope = _f(0.0, qx, qy, waves)[1]
            if slope + half < 0.0:
                low, side = 0.0, half
            elif slope - half > 0.0:
                high = 0.0
            else:
                low = high = 0.0
        x = qx + side
        if j == 0 or j == last:
            slope = _f(a, x, qy, waves)[1]
            if (j == 0 and slope >= 0.0) or (j == last and slope <= 0.0):
                low = high = a
        if low < high:
            a = _polish(a, low, high, x, qy, waves)
        value = _f(a, x, qy, waves)[0]
        if value < best:
            best, where = value, a
    return best, where


@compiled(error_model="numpy")
def _margin_at(
    t: float, px: float, py: float, horizon: float, omega: float, half: float, hold: float,
    value: Floats, slope: Floats, nodes: Floats, trig: Floats, raw: Floats, waves: Floats, scan: Floats,
) -> tuple[float, float]:  # fmt: skip
    """Margin at one time and its time derivative (of the active piece, by Danskin's theorem)."""
    z = 2.0 * t / horizon - 1.0
    c, s = math.cos(omega * t), math.sin(omega * t)
    _collapse(value, z, raw)
    _turn(raw, omega * t, waves)
    lx, ly = raw[0] * px + raw[1] * py, raw[2] * px + raw[3] * py
    qx, qy = into_body(c, s, lx, ly)
    for j in range(nodes.shape[0]):
        total = waves[0] + qx * trig[j, 0] + (qy - hold) * trig[j, 1] + half * abs(trig[j, 0])
        for k in range(1, waves.shape[0]):
            total += waves[k] * trig[j, 1 + k]
        scan[j] = total
    best, a = _least(qx, qy - hold, half, nodes, scan, waves)
    turning = _f(a, 0.0, 0.0, waves)[4]
    _collapse(slope, z, raw)
    _turn(raw, omega * t, waves)
    lx, ly = raw[0] * px + raw[1] * py, raw[2] * px + raw[3] * py
    dx, dy = into_body(c, s, lx, ly)
    dx, dy = dx + omega * qy, dy - omega * qx
    growing = _f(a, 0.0, 0.0, waves)[3]
    return best, dx * math.sin(a) + dy * math.cos(a) + growing - omega * turning


@compiled(error_model="numpy")
def _climb(
    k: int, best: float, at: float, bend: float, times: Floats, px: float, py: float,
    horizon: float, omega: float, half: float, hold: float,
    value: Floats, slope: Floats, nodes: Floats, trig: Floats, raw: Floats, waves: Floats, scan: Floats,
) -> tuple[float, float]:  # fmt: skip
    """Polish the local maximum near ``times[k]``; the better of it and (``best``, ``at``).

    The next trial is where the two tangents of the bracket cross: right for a kink, halving the bracket for a
    parabola. It ends when the tangents promise no gain and the bracket is so narrow that second derivatives of the size
    of ``bend`` (m/s^2) cannot change that (the sides of a kink may be convex).
    """
    a = b = times[k]
    va, ga = _margin_at(a, px, py, horizon, omega, half, hold, value, slope, nodes, trig, raw, waves, scan)
    vb, gb = va, ga
    if va > best:
        best, at = va, a
    if ga > 0.0 and k < times.shape[0] - 1:
        b = times[k + 1]
        vb, gb = _margin_at(
            b, px, py, horizon, omega, half, hold, value, slope, nodes, trig, raw, waves, scan
        )
    elif ga < 0.0 and k > 0:
        a = times[k - 1]
        va, ga = _margin_at(
            a, px, py, horizon, omega, half, hold, value, slope, nodes, trig, raw, waves, scan
        )
    for trial in range(100):
        if va > best:
            best, at = va, a
        if vb > best:
            best, at = vb, b
        width = b - a
        if width <= 1e-12 * horizon:
            break
        t = 0.5 * (a + b)
        if ga > 0.0 and gb < 0.0:
            cross = (vb - va + ga * a - gb * b) / (ga - gb)
            goal = COARSE if abs(best) > NEAR else FINE
            if va + ga * (cross - a) - best <= goal and bend * width * width <= 8.0 * goal:
                break
            if trial % 4 < 3:
                # Kept off the ends, so that the bracket closes from both sides.
                t = min(max(cross, a + 0.05 * width), b - 0.05 * width)
        v, g = _margin_at(t, px, py, horizon, omega, half, hold, value, slope, nodes, trig, raw, waves, scan)
        if g > 0.0 and v >= va:
            a, va, ga = t, v, g
        else:
            b, vb, gb = t, v, g
    return best, at


@compiled(error_model="numpy")
def reach_margins(
    points: Floats, times: Floats, horizon: float, omega: float, half: float, hold: float, bend: Floats,
    value: Floats, slope: Floats, nodes: Floats, trig: Floats, margin: Floats, when: Floats,
) -> None:  # fmt: skip
    """Margin (m) of every start over a window of time, and the time at which it is attained.

    ``points`` (P, 2) body-frame starts; ``times`` (T,) ascending, T = 1 asks for that one time;
    ``value``, ``slope`` of a :class:`~safestart.sets.series.ReachSeries` over [0, horizon]; ``nodes`` (J,), J odd,
    and ``trig`` (J, 2 + 2 K) with sin a, cos a, cos 2ka, sin 2ka; ``bend`` (2,) the size of d2m/dt2: a constant
    (m/s^2) and a part per metre of range (1/s^2). Writes ``margin`` and ``when`` (P,).

    Coarse pass: min over the nodes at every time, which bounds the margin from above. Every local maximum that
    could still beat the best one is then polished.
    """
    count, moments, angles = points.shape[0], times.shape[0], nodes.shape[0]
    raw = np.empty(value.shape[1])
    waves = np.empty(value.shape[1] - DRIFT)
    scan = np.empty(angles)
    if moments == 1:
        for i in range(count):
            margin[i], _ = _margin_at(
                times[0], points[i, 0], points[i, 1], horizon, omega, half, hold,
                value, slope, nodes, trig, raw, waves, scan,
            )  # fmt: skip
            when[i] = times[0]
        return
    drift = np.empty((moments, DRIFT))
    offset = np.empty((moments, angles))
    for m in range(moments):
        c, s = math.cos(omega * times[m]), math.sin(omega * times[m])
        _collapse(value, 2.0 * times[m] / horizon - 1.0, raw)
        _turn(raw, omega * times[m], waves)
        drift[m, 0], drift[m, 2] = into_body(c, s, raw[0], raw[2])
        drift[m, 1], drift[m, 3] = into_body(c, s, raw[1], raw[3])
        for j in range(angles):
            total = waves[0] + half * abs(trig[j, 0]) - hold * trig[j, 1]
            for k in range(1, waves.shape[0]):
                total += waves[k] * trig[j, 1 + k]
            offset[m, j] = total
    coarse = np.empty((moments, BLOCK))
    x, y = np.zeros(BLOCK), np.zeros(BLOCK)
    qx, qy = np.empty(BLOCK), np.empty(BLOCK)
    for first in range(0, count, BLOCK):
        size = min(BLOCK, count - first)
        for i in range(size):
            x[i], y[i] = points[first + i, 0], points[first + i, 1]
        for m in range(moments):
            row = coarse[m]
            for i in range(BLOCK):
                qx[i] = drift[m, 0] * x[i] + drift[m, 1] * y[i]
                qy[i] = drift[m, 2] * x[i] + drift[m, 3] * y[i]
                row[i] = math.inf
            for j in range(angles):
                sine, cosine, extra = trig[j, 0], trig[j, 1], offset[m, j]
                for i in range(BLOCK):
                    f = sine * qx[i] + cosine * qy[i] + extra
                    row[i] = f if f < row[i] else row[i]
        for i in range(size):
            top = 0
            for m in range(1, moments):
                if coarse[m, i] > coarse[top, i]:
                    top = m
            curvature = bend[0] + bend[1] * math.hypot(x[i], y[i])
            best, at = _climb(
                top, -math.inf, times[top], curvature, times, x[i], y[i], horizon, omega, half, hold,
                value, slope, nodes, trig, raw, waves, scan,
            )  # fmt: skip
            for m in range(moments):
                now = coarse[m, i]
                before = coarse[m - 1, i] if m > 0 else -math.inf
                after = coarse[m + 1, i] if m < moments - 1 else -math.inf
                if m == top or before >= now or after > now:
                    continue
                # Between nodes a peak rises about as far as its steeper side extends; twice that leaves room for
                # steepening sides.
                rise = 2.0 * max(now - before if m > 0 else 0.0, now - after if m < moments - 1 else 0.0)
                if now + rise > best:
                    best, at = _climb(
                        m, best, at, curvature, times, x[i], y[i], horizon, omega, half, hold,
                        value, slope, nodes, trig, raw, waves, scan,
                    )  # fmt: skip
            margin[first + i], when[first + i] = best, at


def trig_table(nodes: Floats, harmonics: int) -> Floats:
    """sin a, cos a, then cos 2ka, sin 2ka for k = 1..harmonics, shape (J, 2 + 2 harmonics)."""
    out = np.empty((len(nodes), 2 + 2 * harmonics))
    out[:, 0], out[:, 1] = np.sin(nodes), np.cos(nodes)
    k = 2.0 * np.arange(1, harmonics + 1)
    out[:, 2::2], out[:, 3::2] = np.cos(np.outer(nodes, k)), np.sin(np.outer(nodes, k))
    return out

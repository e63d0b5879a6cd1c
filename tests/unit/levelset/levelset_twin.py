"""Plain NumPy twin of the level-set kernels: one Euler step of any scheme, flux, boundary and set of inputs."""

import itertools
from typing import Any

import numpy as np

from safestart.levelset import Ball, Flux, Kind, Lattice, Motion, Scheme

WIDTH = {Scheme.FIRST: 1, Scheme.ENO2: 2, Scheme.WENO3: 2, Scheme.ENO3: 3, Scheme.WENO5: 3}
EPS = 1e-6


def pad(values: np.ndarray, axis: int, width: int, boundary: str) -> np.ndarray:
    v = np.moveaxis(values, axis, -1)
    around = [(0, 0)] * (v.ndim - 1) + [(width, width)]
    if boundary == "periodic":
        out = np.pad(v, around, "wrap")
    else:
        out = np.pad(v, around, "edge")
        if boundary != "edge":
            for k in range(1, width + 1):
                for end, inner, to in ((0, 1, width - k), (-1, -2, out.shape[-1] - 1 - width + k)):
                    slope = v[..., end] - v[..., inner]
                    if boundary == "extrapolate_away_from_zero":
                        slope = np.sign(v[..., end]) * np.abs(slope)
                    out[..., to] = v[..., end] + k * slope
    return np.moveaxis(out, -1, axis)


def derivatives(
    values: np.ndarray, axis: int, spacing: float, scheme: Scheme, boundary: str
) -> tuple[np.ndarray, np.ndarray]:
    width, count = WIDTH[scheme], values.shape[axis]
    d = np.diff(pad(values, axis, width, boundary), axis=axis) / spacing
    ds = [np.take(d, range(k, k + count), axis) for k in range(2 * width)]
    if scheme is Scheme.FIRST:
        return ds[0], ds[1]
    es = [b - a for a, b in itertools.pairwise(ds)]
    if scheme is Scheme.ENO2:
        left = np.where(abs(es[1]) < abs(es[0]), es[1], es[0])
        right = np.where(abs(es[2]) < abs(es[1]), es[2], es[1])
        return ds[1] + left / 2, ds[2] - right / 2
    if scheme is Scheme.WENO3:
        w = [1 / (e**2 + EPS) ** 2 for e in es]
        left = (w[0] * es[0] + 2 * w[1] * es[1]) / (w[0] + 2 * w[1])
        right = (2 * w[1] * es[1] + w[2] * es[2]) / (2 * w[1] + w[2])
        return ds[1] + left / 2, ds[2] - right / 2
    q = [
        ds[0] / 3 - 7 / 6 * ds[1] + 11 / 6 * ds[2],
        -ds[1] / 6 + 5 / 6 * ds[2] + ds[3] / 3,
        ds[2] / 3 + 5 / 6 * ds[3] - ds[4] / 6,
        11 / 6 * ds[3] - 7 / 6 * ds[4] + ds[5] / 3,
    ]
    if scheme is Scheme.ENO3:
        f = [abs(b - a) for a, b in itertools.pairwise(es)]
        sides = []
        for k in (0, 1):
            up = np.where(f[k + 2] < f[k + 1], q[k + 2], q[k + 1])
            down = np.where(f[k + 1] < f[k], q[k + 1], q[k])
            sides.append(np.where(abs(es[k + 2]) < abs(es[k + 1]), up, down))
        return sides[0], sides[1]
    sides = []
    for k, weights in ((0, (0.1, 0.6, 0.3)), (1, (0.3, 0.6, 0.1))):
        a, b, c, e = es[k : k + 4]
        smooth = [
            4 / 3 * a * a - 11 / 3 * a * b + 10 / 3 * b * b,
            4 / 3 * b * b - 5 / 3 * b * c + 4 / 3 * c * c,
            10 / 3 * c * c - 11 / 3 * c * e + 4 / 3 * e * e,
        ]
        w = [g / (s + EPS) ** 2 for g, s in zip(weights, smooth, strict=True)]
        sides.append(sum(x * y for x, y in zip(w, q[k : k + 3], strict=True)) / sum(w))
    return sides[0], sides[1]


def euler(
    lattice: Lattice,
    motion: Motion,
    values: np.ndarray,
    dt: float,
    time: float,
    scheme: Scheme,
    flux: Flux = Flux.LAX_FRIEDRICHS,
    kind: Kind = Kind.FIXED,
) -> np.ndarray:
    """V + dt H, and nothing clever."""
    n, rates = lattice.ndim, motion.rates(lattice, time)
    zero = np.zeros(lattice.shape)
    f: list[Any] = [zero + sum(terms) for terms in rates.drift]
    spread, kink = [zero] * n, [zero] * n
    gains = [
        [[zero if g is None else g + zero for g in column] for column in player] for player in rates.gains
    ]
    for (bound, aim, _), columns in zip(motion.bounds, gains, strict=True):
        sign = 1 if aim == "max" else -1
        for i in range(n):
            f[i] = f[i] + sum(c[i] * m for c, m in zip(columns, bound.middle, strict=True))
            if isinstance(bound, Ball):
                most = bound.radius * np.sqrt(sum(c[i] ** 2 for c in columns))
            else:
                most = sum(abs(c[i]) * h for c, h in zip(columns, bound.half, strict=True))
            spread[i], kink[i] = spread[i] + most, kink[i] + sign * most
    sides = [derivatives(values, i, lattice.spacing[i], scheme, lattice.boundary[i].value) for i in range(n)]
    total: Any = zero
    if flux is Flux.GODUNOV:
        for i, (low, high) in enumerate(sides):

            def h(p: np.ndarray, i: int = i) -> np.ndarray:
                return np.asarray(f[i] * p + kink[i] * abs(p))

            middle = np.where(low * high < 0, 0.0, h(low))
            three = np.stack([h(low), h(high), middle])
            total = total + np.where(low <= high, three.max(axis=0), three.min(axis=0))
    else:
        p = [(a + b) / 2 for a, b in sides]
        for i, (a, b) in enumerate(sides):
            total = total + f[i] * p[i] + (abs(f[i]) + spread[i]) * (b - a) / 2
        for (bound, aim, price), columns in zip(motion.bounds, gains, strict=True):
            sign = 1 if aim == "max" else -1
            slopes = [sum(g * q for g, q in zip(c, p, strict=True)) for c in columns]
            if isinstance(bound, Ball):
                total = total + sign * bound.radius * np.maximum(
                    np.sqrt(sum(s**2 for s in slopes)) - price, 0
                )
            else:
                for s, half in zip(slopes, bound.half, strict=True):
                    total = total + sign * half * np.maximum(abs(s) - price, 0)
    if kind is Kind.TUBE:
        total = np.minimum(total, 0.0)
    if kind is Kind.ALWAYS:
        total = np.maximum(total, 0.0)
    return np.asarray(values + dt * total)

"""Whether a printed claim is true, by cone programs over densely sampled flights that share no code with the product.

Motion by matrix exponentials, corridor and turn written down again, Clarabel for the program. Samples alone make the
best margin look larger than it is: a claim "at least m" is false where even that falls short of m. A flight of the
program's thrust, sampled more densely, makes it look as large as it certainly is but for what happens between samples:
a claim "at most m" is false where that exceeds m.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from functools import lru_cache
from random import Random
from typing import Any, Literal

import clarabel
import numpy as np
from scipy.linalg import expm

from tests.fuzzing.cone import largest
from tests.fuzzing.plane.printed import Printed

Truth = Literal["true", "false", "open"]
_SAMPLES, _DENSE, _MOST = 24, 12, 400
_TURN = 0.03
_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Member:
    """One question with all numbers known; ``start`` (2 d,)."""

    rate: float
    motion: float
    thrust: float
    start: tuple[float, ...]


def truth(claim: Printed, rng: Random) -> Truth:
    """ "true" means: nothing was found against it; "open": too coarse or too large for these programs."""
    if claim.keep_out > claim.plane or (claim.margin > 0.0) is not (claim.verdict == "GO"):
        return "false"
    try:
        return _go(claim, rng) if claim.verdict == "GO" else _no_go(claim, rng)
    except _Unsolved:
        return "open"


class _Unsolved(Exception):
    pass


def _go(claim: Printed, rng: Random) -> Truth:
    known = replace(claim, half=(0.0,) * len(claim.half)) if claim.who == "per_corner" else claim
    for centre in _corners(claim) if claim.who == "per_corner" else [claim.start]:
        members = _members(replace(known, start=centre), claim.thrusts[0], rng)
        reached = max(best(claim, members, end)[0] for end in range(claim.ends[0], claim.ends[1] + 1))
        if reached < claim.margin - _slack(claim):
            return "false"
    return "true"


def _no_go(claim: Printed, rng: Random) -> Truth:
    """A member that does better, with a start of the box that is free to choose."""
    coarse = False
    for member in _members(replace(claim, half=(0.0,) * len(claim.half)), claim.thrusts[1], rng):
        for end in range(claim.ends[0], claim.ends[1] + 1):
            _, sure, fine = best(claim, [member], end, free=any(claim.half))
            if sure > claim.margin + _slack(claim):
                if fine:
                    return "false"
                coarse = True
    return "open" if coarse else "true"


def _slack(claim: Printed) -> float:
    reach = math.hypot(*claim.start) + claim.dt * claim.ends[1] * (
        math.hypot(*claim.start[claim.d :]) + claim.dt * claim.ends[1] * claim.thrusts[1]
    )
    return _TOLERANCE * (1.0 + 1e-3 * reach + abs(claim.margin))


def _corners(claim: Printed) -> list[tuple[float, ...]]:
    sides = [sorted({c - h, c + h}) for c, h in zip(claim.start, claim.half, strict=True)]
    return list(itertools.product(*sides))


def _members(claim: Printed, thrust: float, rng: Random) -> list[Member]:
    """All ends of the parameters and one member between them, with the corners of the start box (at most 16)."""
    corners = _corners(claim)
    kept = corners if len(corners) <= 16 else rng.sample(corners, 16)
    ends = [list(dict.fromkeys(pair)) for pair in (claim.rates, claim.motions)]
    params = list(itertools.product(*ends))
    if len(params) > 1:
        params.append((rng.uniform(*claim.rates), rng.uniform(*claim.motions)))
    return [Member(w, n, thrust, start) for w, n in params for start in kept]


@lru_cache(maxsize=256)
def steps_of(n: float, dt: float, d: int, count: int) -> tuple[Any, Any]:
    """Phi (count + 1, 2 d, 2 d) and held input (count + 1, 2 d, d) at equal times of an interval."""
    a = np.zeros((2 * d + d, 2 * d + d))
    a[:d, d : 2 * d] = np.eye(d)
    a[d, 0], a[d, d + 1], a[d + 1, d] = 3.0 * n * n, 2.0 * n, -2.0 * n
    if d == 3:
        a[5, 2] = -n * n
    a[d : 2 * d, 2 * d :] = np.eye(d)
    one = expm(a * dt / count)
    out = [np.eye(3 * d)]
    for _ in range(count):
        out.append(one @ out[-1])
    stacked = np.array(out)
    return stacked[:, : 2 * d, : 2 * d], stacked[:, : 2 * d, 2 * d :]


def _flown(claim: Printed, member: Member, end: int, count: int) -> tuple[Any, Any, Any]:
    """Times (K,), state from the start (K, 2 d, 2 d) and from the thrust (K, 2 d, end d)."""
    d = claim.d
    phi, held = steps_of(member.motion, claim.dt, d, count)
    carry, drive = np.eye(2 * d), np.zeros((2 * d, end * d))
    times, free, driven = [], [], []
    for k in range(end):
        for j in range(0 if k == 0 else 1, count + 1):
            times.append(claim.dt * (k + j / count))
            free.append(phi[j] @ carry)
            now = phi[j] @ drive
            now[:, k * d : k * d + d] += held[j]
            driven.append(now)
        carry, drive = free[-1], driven[-1]
    return np.array(times), np.array(free), np.array(driven)


def rows_of(claim: Printed, member: Member, end: int, count: int) -> tuple[Any, Any, Any, list[Any]]:
    """Face distances constant + thrust . u, (J,), (J, end d), how the start moves them (J, 2 d), and the cones.

    A cone is (limit, constant, thrust, start): limit - |constant + thrust u| is a margin.
    """
    d, w = claim.d, member.rate
    times, free, driven = _flown(claim, member, end, count)
    normals = [np.r_[0.0, -1.0, np.zeros(d - 2)]]
    offsets = [-claim.plane]
    for axis, (slope, width) in zip((0, 2), claim.sides, strict=False):
        for sign in (1.0, -1.0):
            normal = np.zeros(d)
            normal[axis], normal[1] = sign, -slope
            normals.append(normal / math.hypot(1.0, slope))
            offsets.append((width - slope * claim.plane) / math.hypot(1.0, slope))
    c, s = np.cos(w * times), np.sin(w * times)
    turn = np.zeros((len(times), d, d))
    turn[:, 0, 0] = turn[:, 1, 1] = c
    turn[:, 0, 1], turn[:, 1, 0] = s, -s
    if d == 3:
        turn[:, 2, 2] = 1.0
    along = -np.array(normals) @ turn
    start, thrust = along @ free[:, :d], along @ driven[:, :d]
    x0 = np.array(member.start)
    constant = np.array(offsets) + start @ x0
    cones: list[Any] = []
    if claim.speed is not None:
        cones += [
            (claim.scale * claim.speed, claim.scale * f[d:] @ x0, claim.scale * g[d:], claim.scale * f[d:])
            for f, g in zip(free, driven, strict=True)
        ]
    if claim.hold:
        f, g, r = free[-1], driven[-1], turn[-1]
        cones.append((claim.radius, r @ f[:d] @ x0 - np.array(claim.hold), r @ g[:d], r @ f[:d]))
        spin = np.zeros((d, d))
        spin[0, 1], spin[1, 0] = -w, w
        scale = claim.radius / claim.rest
        f, g = scale * (f[d:] - spin @ f[:d]), scale * (g[d:] - spin @ g[:d])
        cones.append((claim.radius, f @ x0, g, f))
    size = end * d
    return constant.ravel(), thrust.reshape(-1, size), start.reshape(-1, 2 * d), cones


def best(claim: Printed, members: list[Member], end: int, *, free: bool = False) -> tuple[float, float, bool]:
    """Margin of the best common history with samples alone; what its flights keep; whether samples lie close."""
    fastest = max(member.rate for member in members)
    wanted = max(_SAMPLES, math.ceil(claim.dt * fastest / _TURN), math.ceil(claim.dt / 2.0))
    count = min(_MOST, wanted)
    rows = [rows_of(claim, member, end, count) for member in members]
    bound, u, moved = _solve(claim, rows, members[0].thrust, end, free)
    kept, dense = math.inf, min(_MOST * _DENSE, _DENSE * count)
    for member in members:
        constant, thrust, start, cones = rows_of(claim, member, end, dense)
        kept = min(kept, float((constant + thrust @ u + start @ moved).min()))
        kept = min(
            kept, *(limit - np.linalg.norm(a + g @ u + f @ moved) for limit, a, g, f in cones), math.inf
        )
    # Between dense samples h apart a distance falls short by at most h^2 / 8 of its curvature.
    h = claim.dt / dense
    far = max(math.hypot(*member.start) for member in members) + claim.dt * end * (
        max(math.hypot(*member.start[claim.d :]) for member in members) + claim.dt * end * members[0].thrust
    )
    lost = (
        h
        * h
        / 8.0
        * (fastest**2 * far + 2.0 * fastest * (far / max(claim.dt * end, 1.0)) + members[0].thrust)
    )
    return bound, kept - lost, wanted <= _MOST


def _solve(claim: Printed, rows: list[Any], a_max: float, end: int, free: bool) -> tuple[float, Any, Any]:
    """Maximise m over u (and the start's move within the half-widths): bound, u, move."""
    d, size = claim.d, end * claim.d
    wide = np.array(claim.half) if free else np.zeros(2 * d)
    axes = np.nonzero(wide > 0.0)[0]
    columns = size + len(axes) + 1
    plain = np.vstack(
        [np.hstack([-r[1], -r[2][:, axes] * wide[axes], np.ones((len(r[0]), 1))]) for r in rows]
    )
    left, right, kinds = [plain], [np.concatenate([r[0] for r in rows])], [len(plain)]
    if len(axes):
        box = np.zeros((2 * len(axes), columns))
        box[: len(axes), size : size + len(axes)] = np.eye(len(axes))
        box[len(axes) :, size : size + len(axes)] = -np.eye(len(axes))
        left.append(box)
        right.append(np.ones(2 * len(axes)))
        kinds[0] += len(box)
    cones: list[Any] = [clarabel.NonnegativeConeT(kinds[0])]
    for limit, constant, thrust, start in (cone for r in rows for cone in r[3]):
        block = np.zeros((d + 1, columns))
        block[0, -1] = 1.0
        block[1:, :size], block[1:, size:-1] = -thrust, -start[:, axes] * wide[axes]
        # The same cone in numbers near 1: at 1e7 m for 1 m/s Clarabel's answer was off by more than the margin.
        share = 1.0 / max(1.0, abs(limit))
        left.append(share * block)
        right.append(share * np.r_[limit, constant])
        cones.append(clarabel.SecondOrderConeT(d + 1))
    for k in range(end):
        block = np.zeros((d + 1, columns))
        block[1:, k * d : k * d + d] = -np.eye(d)
        left.append(block)
        right.append(np.r_[1.0, np.zeros(d)])
        cones.append(clarabel.SecondOrderConeT(d + 1))
    a, b = np.vstack(left), np.concatenate(right)
    # Thrusts in units of a_max.
    held = kinds[0] + sum(d + 1 for r in rows for _ in r[3])
    a[:held, :size] *= a_max
    found, well = largest(a, b, cones)
    if not well:
        raise _Unsolved(str(found.status))
    x = np.array(found.x)
    u = x[:size].reshape(end, d)
    u = a_max * u / np.maximum(1.0, np.linalg.norm(u, axis=1))[:, None]
    moved = np.zeros(2 * d)
    moved[axes] = wide[axes] * np.clip(x[size:-1], -1.0, 1.0)
    return max(-float(found.obj_val), -float(found.obj_val_dual)), u.ravel(), moved

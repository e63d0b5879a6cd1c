"""Whether a printed missed-burn claim is true: drawn members of it flown by SciPy; no code of the product.

A claim is false where one of them comes nearer than it says. Members lie at the edges of errors and failures.
"""

from __future__ import annotations

import math
from random import Random
from typing import Any, Literal

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import lsq_linear

from tests.fuzzing.abort.printed import Printed

Truth = Literal["true", "false", "open"]
_FLIGHTS = 14
_TOLERANCE = 1e-5


class Course:
    """The motion of one model: LVLH states (6,) of the chaser from a time (s) on, under an LVLH thrust (3,)."""

    def __init__(self, claim: Printed) -> None:
        self.claim = claim

    def flown(self, state: Any, begin: float, length: float, push: Any) -> tuple[Any, Any]:
        """States (T, 6) at equal times over ``length`` s, and the last one."""
        if length <= 0.0:
            return state[None], state
        times = np.linspace(0.0, length, max(2, math.ceil(length / 5.0)) + 1)
        if self.claim.earth is not None:
            found = self._about_earth(state, begin, times, push)
        else:
            rates = self._linear if self.claim.radius is None else self._round
            found = solve_ivp(
                rates, (0.0, length), state, "DOP853", times, args=(push,), rtol=1e-11, atol=1e-9
            ).y.T
        return found, found[-1]

    def _linear(self, _: float, y: Any, push: Any) -> Any:
        n = self.claim.n
        return np.array(
            [
                *y[3:],
                3.0 * n * n * y[0] + 2.0 * n * y[4] + push[0],
                -2.0 * n * y[3] + push[1],
                -n * n * y[2] + push[2],
            ]
        )

    def _round(self, _: float, y: Any, push: Any) -> Any:
        n, r = self.claim.n, self.claim.radius
        x = np.array([r + y[0], y[1], y[2]])
        pull = n * n * r**3 / (x @ x) ** 1.5
        return np.array(
            [
                *y[3:],
                2.0 * n * y[4] + n * n * x[0] - pull * x[0] + push[0],
                -2.0 * n * y[3] + n * n * y[1] - pull * y[1] + push[1],
                -pull * y[2] + push[2],
            ]
        )

    def _gravity(self, r: Any) -> Any:
        earth = self.claim.earth
        size = math.sqrt(r @ r)
        bulge = 1.5 * earth["j2"] * earth["mu"] * earth["size"] ** 2 / size**5
        ratio = 5.0 * (r[2] / size) ** 2
        return -earth["mu"] / size**3 * r - bulge * r * np.array([1.0 - ratio, 1.0 - ratio, 3.0 - ratio])

    def _axes(self, target: Any) -> tuple[Any, Any]:
        r, v = target[:3], target[3:]
        h = np.cross(r, v)
        x, z = r / np.linalg.norm(r), h / np.linalg.norm(h)
        rows = np.array([x, np.cross(z, x), z])
        across = self._gravity(r) @ z
        omega = np.linalg.norm(h) / (r @ r) * z + np.linalg.norm(r) * across / np.linalg.norm(h) * x
        return rows, omega

    def _about_earth(self, state: Any, begin: float, times: Any, push: Any) -> Any:
        target = self.target(begin)
        rows, omega = self._axes(target)
        place = rows.T @ state[:3]
        chaser = np.r_[place, rows.T @ state[3:] + np.cross(omega, place)]

        def rates(_: float, y: Any) -> Any:
            rows, _omega = self._axes(y[:6])
            r = y[:3]
            return np.concatenate(
                [
                    y[3:6],
                    self._gravity(r),
                    y[9:],
                    self._gravity(r + y[6:9]) - self._gravity(r) + rows.T @ push,
                ]
            )

        found = solve_ivp(
            rates, (0.0, times[-1]), np.r_[target, chaser], "DOP853", times, rtol=1e-11, atol=1e-7
        ).y.T
        out = []
        for y in found:
            rows, omega = self._axes(y[:6])
            out.append(np.r_[rows @ y[6:9], rows @ (y[9:] - np.cross(omega, y[6:9]))])
        return np.array(out)

    def target(self, begin: float) -> Any:
        """The target's inertial state ``begin`` s after the first burn."""
        state = self.claim.earth["state"]
        if begin <= 0.0:
            return state
        return solve_ivp(
            lambda _, y: np.r_[y[3:], self._gravity(y[:3])],
            (0.0, begin),
            state,
            "DOP853",
            rtol=1e-12,
            atol=1e-7,
        ).y[:, -1]


def _planned(claim: Printed, k: int) -> Any:
    """The plan's state before burn k."""
    if claim.earth is not None:
        return claim.before[k]
    linear = Course(claim)
    state = claim.start
    for j in range(k):
        burn, n = claim.burns[j], claim.n
        length = claim.burns[j + 1].time - burn.time
        if burn.lasts:
            args = (burn.impulse / burn.lasts,)
            state = solve_ivp(
                linear._linear, (0.0, burn.lasts), state, "DOP853", args=args, rtol=1e-12, atol=1e-10
            ).y[:, -1]
            length -= burn.lasts
        else:
            state = state + np.r_[0.0, 0.0, 0.0, burn.impulse]
        if length > 0.0:
            state = solve_ivp(
                linear._linear, (0.0, length), state, "DOP853", args=(np.zeros(3),), rtol=1e-12, atol=1e-10
            ).y[:, -1]
        assert n is not None
    return state


def _turned(v: Any, angle: float, gen: Any) -> Any:
    if angle <= 0.0:
        return v
    across = np.cross(v, gen.normal(size=3))
    across *= np.linalg.norm(v) / np.linalg.norm(across)
    by = angle * gen.choice([1.0, gen.uniform()])
    return math.cos(by) * v + math.sin(by) * across


def truth_of_drifts(claim: Printed, rng: Random) -> Truth:
    """ "true" means: no flight that was drawn comes nearer than the claim."""
    if claim.least < claim.keep_out:
        return "false"
    gen = np.random.default_rng(rng.randrange(2**32))
    kinds = ["start", "made"]
    kinds += ["partial"] * claim.partial + ["late"] * (claim.late > 0) + ["stuck"] * (claim.stuck > 0)
    kinds += ["misdirected"] * (claim.misdirected > 0) + ["cut"] * claim.early
    course = Course(claim)
    flights = _FLIGHTS if claim.earth is None else 5
    planned = [_planned(claim, k) for k in range(len(claim.burns))]
    for j in range(flights):
        kind = kinds[j % len(kinds)]
        k = 0 if kind == "start" else int(gen.integers(len(claim.burns)))
        if kind == "cut" and not claim.burns[k].lasts:
            continue
        places = _flight(claim, course, planned, kind, k, gen)
        if _nearest(claim, places) < claim.least - _TOLERANCE * (1.0 + claim.least):
            return "false"
    return "true"


def _flight(claim: Printed, course: Course, planned: list[Any], kind: str, burn: int, gen: Any) -> Any:
    """Places (T, 3) from the case's event on."""
    first = burn if claim.anew else 0
    off = claim.box * gen.choice([-1.0, 1.0], 6)
    if claim.ellipsoid is not None:
        unit = gen.normal(size=6)
        off = off + claim.ellipsoid @ (unit / np.linalg.norm(unit))
    state, begin, none = planned[first] + off, claim.burns[first].time - claim.burns[0].time, np.zeros(3)
    seen: list[Any] = []
    if kind == "start":
        found, _ = course.flown(state, begin, max(claim.horizon, claim.late), none)
        return found[:, :3]
    for k in range(first, burn + 1):
        made, last = claim.burns[k], k == burn
        impulse = (1.0 + claim.share * gen.choice([-1.0, 1.0])) * _turned(made.impulse, claim.angle, gen)
        lasts = made.lasts
        if last and kind == "misdirected":
            impulse = _turned(impulse, claim.misdirected, gen)
        if last and kind == "partial":
            impulse = impulse * gen.choice([0.0, 1.0, gen.uniform()])
        if last and kind == "late":
            wait = claim.late * gen.choice([1.0, gen.uniform()])
            found, state = course.flown(state, begin, wait, none)
            seen.append(found)
            begin += wait
        push = impulse / lasts if lasts else none
        if lasts:
            on = lasts * (gen.uniform() if last and kind == "cut" else 1.0)
            found, state = course.flown(state, begin, on, push)
            seen.append(found)
            begin += on
        else:
            state = state + np.r_[0.0, 0.0, 0.0, impulse]
        if last and kind == "stuck":
            on = claim.stuck * gen.choice([1.0, gen.uniform()])
            if not lasts:
                unit = _turned(made.impulse / np.linalg.norm(made.impulse), claim.angle, gen)
                push = claim.acceleration * (1.0 + claim.share * gen.choice([-1.0, 1.0])) * unit
            found, state = course.flown(state, begin, on, push)
            seen.append(found)
            begin += on
        if not last:
            until = claim.burns[k + 1].time - claim.burns[0].time
            found, state = course.flown(state, begin, until - begin, none)
            seen, begin = [], until
    length = claim.horizon
    if kind == "made" and burn + 1 < len(claim.burns):
        length = max(length, claim.burns[burn + 1].time - claim.burns[burn].time + claim.late)
    found, _ = course.flown(state, begin, length, none)
    return np.concatenate([*seen, found])[:, :3]


def _nearest(claim: Printed, places: Any) -> float:
    out = math.inf
    for kind, centre, columns in claim.zones:
        away = places - centre
        reach = np.linalg.norm(columns, 2) * (math.sqrt(3.0) if kind == "box" else 1.0)
        far = np.linalg.norm(away, axis=1)
        if kind == "sphere":
            out = min(out, float(far.min()) - float(columns[0, 0]))
            continue
        # Only where the zone may be near enough.
        for k in np.argsort(far)[:40]:
            if far[k] - reach >= out:
                break
            out = min(out, _away(kind, columns, away[k]))
    return out


def _away(kind: str, columns: Any, point: Any) -> float:
    if kind == "box":
        return float(np.sqrt(2.0 * lsq_linear(columns, point, (-1.0, 1.0), tol=1e-12).cost))
    inner = np.linalg.lstsq(columns, point, rcond=None)[0]
    if np.linalg.norm(inner) <= 1.0 and np.allclose(columns @ inner, point):
        return 0.0
    u, s, vt = np.linalg.svd(columns)
    seen = u.T @ point
    low, high = 0.0, 1e12
    for _ in range(200):
        middle = 0.5 * (low + high) if high < 1.0 else math.sqrt(max(low, 1e-12) * high)
        b = s * seen / (s * s + middle)
        low, high = (middle, high) if np.linalg.norm(b) > 1.0 else (low, middle)
    b = s * seen / (s * s + high)
    return float(np.linalg.norm(u @ (s * b) - point)) if vt is not None else math.inf

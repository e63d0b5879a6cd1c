"""The flight of one member of a case's set: actual states and burns that anyone can fly again."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from safestart.dynamics.burn import frame, misdirected
from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.dynamics.two_body_kernel import STAGES, WEIGHTS, drifted, placed, seen
from safestart.missed_burn.earth.motion import burnt, target_before
from safestart.missed_burn.plan import Question
from safestart.missed_burn.sets import Case, shell
from safestart.missed_burn.zone import POINT, Zone
from safestart.model.scenario import Floats


@dataclass(frozen=True, slots=True)
class MemberFlight:
    """From ``start`` (6,) at ``begin`` s: the ``impulses`` (K, 3) at ``times`` (K,), each spread evenly over its
    ``durations`` (K,), s, then the ``push`` (3,), m/s^2, held for ``push_for`` s after the last of them, then drift;
    looked at ``look`` s. LVLH, times of the plan. ``target`` (6,): its inertial state at ``begin``, for a flight about
    the true Earth.
    """

    mean_motion: float
    kind: str
    burn: int
    start: Floats
    begin: float
    times: Floats
    impulses: Floats
    durations: Floats
    push: Floats
    push_for: float
    look: float
    target: Floats | None = None

    def state(self) -> Floats:
        """State (6,) at ``look``, in CWH motion."""
        n, state, now = self.mean_motion, np.array(self.start), self.begin
        for time, impulse, duration in zip(self.times, self.impulses, self.durations, strict=True):
            state, now = transition_matrix(n, time - now) @ state, time
            on = min(duration, self.look - now)
            if duration == 0.0:
                state[3:] += impulse
            elif on > 0.0:
                state = transition_matrix(n, on) @ state + input_matrix(n, on) @ (impulse / duration)
                now += on
        if self.push_for > 0.0:
            on = min(self.push_for, self.look - now)
            state = transition_matrix(n, on) @ state + input_matrix(n, on) @ self.push
            now += on
        reached: Floats = transition_matrix(n, self.look - now) @ state
        return reached

    def distance(self, radius: float | None = None, zone: Zone = POINT) -> float:
        """Distance to the target, or to the ``zone``, at ``look``, m; with the ``radius`` (m) of the orbit in the
        nonlinear motion."""
        if self.target is not None:
            state = self.earth_state()
        else:
            state = self.state() if radius is None else self.nonlinear_state(radius)
        return zone.distance(state[:3])

    def earth_state(self) -> Floats:
        """State (6,) at ``look``, both bodies about the Earth with J2."""
        reached: Floats = seen(self.earth_flight())
        return reached

    def earth_flight(self) -> Floats:
        """The same as a flight (12,) of :mod:`safestart.dynamics.two_body_kernel`."""
        assert self.target is not None
        flight, now = placed(self.target, self.start), self.begin
        for time, impulse, duration in zip(
            self.times.tolist(), self.impulses, self.durations.tolist(), strict=True
        ):
            flight, _ = drifted(flight, time - now, STAGES, WEIGHTS)
            on = min(duration, self.look - time)
            if duration == 0.0 or on > 0.0:
                flight = burnt(flight, impulse if duration == 0.0 else impulse * (on / duration), on)
            now = time + max(on, 0.0)
        if self.push_for > 0.0:
            on = min(self.push_for, self.look - now)
            flight = burnt(flight, on * self.push, on)
            now += on
        reached: Floats = drifted(flight, self.look - now, STAGES, WEIGHTS)[0]
        return reached

    def nonlinear_state(self, radius: float) -> Floats:
        """State (6,) at ``look`` about a point mass, the target on a circular orbit of ``radius`` m."""
        state, now = np.array(self.start), self.begin
        made = zip(self.times.tolist(), self.impulses, self.durations.tolist(), strict=True)
        for time, impulse, duration in made:
            state, now = self._flown(radius, state, time - now, np.zeros(3)), time
            on = min(duration, self.look - now)
            if duration == 0.0:
                state[3:] += impulse
            elif on > 0.0:
                state, now = self._flown(radius, state, on, impulse / duration), now + on
        if self.push_for > 0.0:
            on = min(self.push_for, self.look - now)
            state = self._flown(radius, state, on, self.push)
            now += on
        return self._flown(radius, state, self.look - now, np.zeros(3))

    def _flown(self, r: float, state: Floats, seconds: float, push: Floats) -> Floats:
        """The full equations of relative motion in LVLH, by DOP853."""
        n = self.mean_motion
        mu = n * n * r**3

        def rates(_: float, s: Floats) -> Floats:
            x, y, z, u, v, w = s
            pull = mu / ((r + x) ** 2 + y * y + z * z) ** 1.5
            return np.array(
                [
                    *(u, v, w),
                    2.0 * n * v + n * n * x - pull * (r + x) + mu / r**2 + push[0],
                    -2.0 * n * u + n * n * y - pull * y + push[1],
                    -pull * z + push[2],
                ]
            )

        if seconds <= 0.0:
            return np.array(state)
        done = solve_ivp(rates, (0.0, seconds), state, method="DOP853", rtol=1e-11, atol=1e-9)
        reached: Floats = done.y[:, -1] if done.success else np.full(6, np.inf)
        return reached


def flown_of(question: Question, case: Case, member: Floats, when: float) -> MemberFlight:
    """The flight of a member (C,) of a case, ``when`` s after the case's time.

    Its burns are clipped to the allowed errors and failures, so its distance must be measured, not taken from the set.
    """
    plan, errors, failures = question.plan, question.errors, question.failures
    base = case.burn if errors.at_each_burn else 0
    base = max(base, 0)
    start, part, on_part = question.before()[base].copy(), 0.0, 0.0
    chosen: dict[int, list[tuple[str, float]]] = {}
    for (label, number), value in zip(case.labels, member.tolist(), strict=True):
        if label == "navigation":
            start[number] += value * (errors.position + errors.velocity)[number]
        elif label == "ellipsoid":
            start += value * np.array(errors.ellipsoid[number])
        elif label == "on":
            on_part = value
        elif label == "piece":
            part = value
        elif label in ("along", "across"):
            chosen.setdefault(number, []).append((label, value))
    event = _within(case.first, case.last, part)
    times, impulses, durations = [], [], []
    for k in range(base, case.burn + 1):
        last = k == case.burn
        angle = errors.thrust_angle + (failures.misdirected if last and case.kind == "misdirected" else 0.0)
        least = 0.0 if last and case.kind == "partial" else 1.0 - errors.thrust_share
        burn = plan.burns[k]
        made = _made(np.array(burn.impulse), chosen.get(k, []), least, 1.0 + errors.thrust_share, angle)
        on = burn.duration
        if last and on > 0.0:
            on = _within(case.thrust.first, case.thrust.last, on_part)
            made = made * (on / burn.duration)
        impulses.append(made)
        durations.append(on)
        times.append(burn.time + (event if last and case.kind == "late" else 0.0))
    push, push_for = np.zeros(3), 0.0
    if case.kind == "stuck" and plan.burns[case.burn].duration == 0.0:
        push_for = event
        push = failures.acceleration / plan.burns[case.burn].size * impulses[-1]
    return MemberFlight(
        mean_motion=plan.mean_motion,
        kind=case.kind,
        burn=case.burn,
        start=start,
        begin=plan.burns[base].time,
        times=np.array(times),
        impulses=np.array(impulses).reshape(-1, 3),
        durations=np.array(durations),
        push=push,
        push_for=push_for,
        look=max(case.time + when, times[-1] if times else 0.0),
        target=None if question.earth is None else target_before(question, base),
    )


def _within(first: float, last: float, part: float) -> float:
    """A time of a piece, by its place in [-1, 1]; the ends of the piece are reached exactly."""
    return min(max(0.5 * (first + last) + 0.5 * (last - first) * part, first), last)


def _made(
    impulse: Floats, chosen: list[tuple[str, float]], least: float, greatest: float, angle: float
) -> Floats:
    """The burn of a member, its size and direction within what is allowed."""
    _, one, two = frame(impulse)
    middle, half, across = shell(least, greatest, angle)
    ahead = middle + half * sum(value for label, value in chosen if label == "along")
    aside = [value for label, value in chosen if label == "across"]
    sideways = across * (aside[0] * one + aside[1] * two) if aside else np.zeros(3)
    off = float(np.linalg.norm(sideways))
    turned = min(math.atan2(off, ahead), angle)
    share = min(max(math.hypot(ahead, off), least), greatest)
    return misdirected(impulse, turned, sideways / off if off > 0.0 else sideways, share)

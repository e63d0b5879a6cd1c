"""The question: a plan of burns on a circular orbit, its errors, the failures of its burns, the keep-out zones."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.errors import invalid
from safestart.missed_burn.zone import MOST_ZONES, POINT, Zone
from safestart.model.scenario import MAX_MEAN_MOTION, Floats, number

_UP = 1.0 + 1e-15

if TYPE_CHECKING:
    from safestart.missed_burn.earth.motion import Earth

MOST_BURNS = 200
LONGEST_PHASE = 0.5
"""Largest delay, length and overrun of a burn, together, as a phase n t of the orbit (rad)."""


@dataclass(frozen=True, slots=True)
class Burn:
    """An impulse (3,), m/s, LVLH axes, at ``time`` s; with a ``duration`` (s) spread evenly over it from then on."""

    time: float
    impulse: tuple[float, float, float]
    duration: float = 0.0

    @property
    def size(self) -> float:
        """|impulse|, m/s."""
        return math.sqrt(math.fsum(x * x for x in self.impulse))

    @property
    def thrust(self) -> float:
        """Acceleration of a burn with a duration, m/s^2."""
        return self.size / self.duration

    def gives(self, n: float) -> Floats:
        """What it adds to the state (6,) at its time, as one from which the chaser drifts ever since, in CWH motion."""
        if self.duration == 0.0:
            return np.array([0.0, 0.0, 0.0, *self.impulse])
        given: Floats = -input_matrix(n, -self.duration) @ (np.array(self.impulse) / self.duration)
        return given


@dataclass(frozen=True, slots=True)
class Plan:
    """Burns in order, from the LVLH state ``start`` (6,), m and m/s, right before the first one."""

    mean_motion: float
    start: tuple[float, ...]
    burns: tuple[Burn, ...]

    def __post_init__(self) -> None:
        number("mean_motion_rad_s", self.mean_motion, 0.0, MAX_MEAN_MOTION, open_low=True)
        if len(self.start) != 6 or not np.isfinite(self.start).all():
            raise invalid("start", "6 finite numbers: position (m) and velocity (m/s)", self.start)
        if not 1 <= len(self.burns) <= MOST_BURNS:
            raise invalid("burns", f"1 to {MOST_BURNS} burns", len(self.burns))
        before = -math.inf
        for k, burn in enumerate(self.burns):
            if not (math.isfinite(burn.time) and np.isfinite(burn.impulse).all() and len(burn.impulse) == 3):
                raise invalid(f"burns.{k}", "a finite time (s) and 3 finite components (m/s)", burn)
            if not burn.time > before:
                raise invalid(f"burns.{k}.time_s", f"later than the burn before, at {before:g} s", burn.time)
            if burn.size == 0.0:
                raise invalid(f"burns.{k}.impulse_m_s", "an impulse that is not zero", burn.impulse)
            number(f"burns.{k}.duration_s", burn.duration, 0.0, 1e5)
            last = k + 1 == len(self.burns)
            if burn.duration and not last and burn.time + burn.duration > self.burns[k + 1].time:
                raise invalid(
                    f"burns.{k}.duration_s",
                    f"an end before the next burn, at {self.burns[k + 1].time:g} s",
                    burn.duration,
                )
            before = burn.time

    @classmethod
    def of(cls, mean_motion: float, start: Sequence[float], times: Sequence[float], impulses: Floats) -> Plan:
        """From arrays: times (K,), s, and impulses (K, 3), m/s."""
        burns = [
            Burn(float(t), (float(v[0]), float(v[1]), float(v[2])))
            for t, v in zip(times, impulses, strict=True)
        ]
        return cls(float(mean_motion), tuple(float(x) for x in start), tuple(burns))

    def before(self) -> Floats:
        """States (K, 6) right before each burn, without failures."""
        state, out = np.array(self.start), []
        for k, burn in enumerate(self.burns):
            if k:
                state = transition_matrix(self.mean_motion, burn.time - self.burns[k - 1].time) @ state
            out.append(state.copy())
            state += burn.gives(self.mean_motion)
        return np.array(out)


@dataclass(frozen=True, slots=True)
class Errors:
    """Bounds on the errors of a plan's states and burns.

    ``position`` and ``velocity``: half-widths of a box, m and m/s. ``thrust_share``: relative error of a burn's size;
    ``thrust_angle``: error of its direction, rad. ``at_each_burn``: the box holds before every burn, because the burns
    are planned again; otherwise it holds only before the first one, and the errors of the burns add up.
    ``ellipsoid``: columns of a matrix (6, 6), L: the states are also off by L b, |b| <= 1. Errors of the thrust of a
    burn with a duration may vary while it burns.
    """

    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    thrust_share: float = 0.0
    thrust_angle: float = 0.0
    at_each_burn: bool = True
    ellipsoid: tuple[tuple[float, ...], ...] = ()

    def __post_init__(self) -> None:
        for name, sizes, most in (("position_m", self.position, 1e6), ("velocity_m_s", self.velocity, 1e3)):
            if len(sizes) != 3:
                raise invalid(f"errors.{name}", "3 half-widths", sizes)
            for size in sizes:
                number(f"errors.{name}", size, 0.0, most)
        number("errors.thrust_share", self.thrust_share, 0.0, 0.99)
        number("errors.thrust_deg", self.thrust_angle, 0.0, 0.5 * math.pi)
        if self.ellipsoid and not (
            np.shape(self.ellipsoid) == (6, 6) and bool((np.abs(self.ellipsoid) <= 1e6).all())
        ):
            raise invalid("errors.covariance", "6 columns of 6 finite numbers", self.ellipsoid)

    def scaled(self, scale: float) -> Errors:
        """Multiply all errors by ``scale``."""
        x, y, z = (scale * size for size in self.position)
        u, v, w = (scale * size for size in self.velocity)
        share, angle = scale * self.thrust_share, scale * self.thrust_angle
        columns = tuple(tuple(scale * e for e in column) for column in self.ellipsoid)
        return Errors((x, y, z), (u, v, w), share, angle, self.at_each_burn, columns)


@dataclass(frozen=True, slots=True)
class Failures:
    """Possible failures of any one burn; no burn follows a failure.

    ``late``: by up to this many s; ``partial``: any part of it is burnt, 0..100 %; ``stuck``: it continues for up to
    this many s at ``acceleration`` m/s^2, or at its own where it has a duration; ``misdirected``: by up to this many
    rad. A missed burn is always included, and so is one with a duration that ends early, at any time.
    """

    late: float = 0.0
    partial: bool = False
    stuck: float = 0.0
    acceleration: float = 0.0
    misdirected: float = 0.0

    def __post_init__(self) -> None:
        number("failures.late_s", self.late, 0.0, 1e5)
        number("failures.stuck_s", self.stuck, 0.0, 1e5)
        number("failures.acceleration_m_s2", self.acceleration, 0.0, 100.0)
        number("failures.misdirected_deg", self.misdirected, 0.0, math.pi)


@dataclass(frozen=True, slots=True)
class Question:
    """``keep_out`` m around the target, or around each of the ``zones``, must stay empty for ``horizon`` s after the
    last completed burn.

    ``radius`` of the circular orbit, m, for an answer about the nonlinear motion (two point masses, mu = n^2 radius^3);
    None: about the linear one. ``earth``: for an answer about two bodies with J2 on any orbit.
    """

    plan: Plan
    keep_out: float
    horizon: float
    errors: Errors = field(default_factory=Errors)
    failures: Failures = field(default_factory=Failures)
    radius: float | None = None
    earth: Earth | None = None
    zones: tuple[Zone, ...] = (POINT,)

    def __post_init__(self) -> None:
        if self.earth is not None and (self.radius is not None or not self.errors.at_each_burn):
            raise invalid("errors.at_each_burn", "true where model is earth, which has no other one", False)
        if self.radius is not None:
            number("semi_major_axis_m", self.radius, 1e3, 1e9)
            if not self.errors.at_each_burn:
                raise invalid(
                    "errors.at_each_burn",
                    "true where model is nonlinear: errors that add up are linear only",
                    False,
                )
        number("keep_out_m", self.keep_out, 0.0, 1e5, open_low=True)
        number("horizon_s", self.horizon, 0.0, 1e6, open_low=True)
        if not 1 <= len(self.zones) <= MOST_ZONES:
            raise invalid("zones", f"1 to {MOST_ZONES} zones", len(self.zones))
        self._fits()

    def _fits(self) -> None:
        """Failures and burns are within reach of the enclosures and of the model."""
        longest, failures = LONGEST_PHASE / self.plan.mean_motion, self.failures
        for name, value in (("late_s", failures.late), ("stuck_s", failures.stuck)):
            if value > longest:
                raise invalid(
                    f"failures.{name}", f"at most {longest:.6g} s, {LONGEST_PHASE} rad of the orbit", value
                )
        burns = self.plan.burns
        for k, burn in enumerate(burns):
            whole = failures.late + burn.duration + failures.stuck
            if burn.duration and whole > longest:
                needed = f"with delay and overrun at most {longest:.6g} s, {LONGEST_PHASE} rad of the orbit"
                raise invalid(f"burns.{k}.duration_s", needed, whole)
        if failures.stuck > 0.0 and failures.acceleration == 0.0 and not all(b.duration for b in burns):
            raise invalid("failures.acceleration_m_s2", "more than 0 where an impulse may be stuck on", 0.0)

    def before(self) -> Floats:
        """LVLH states (K, 6) before each burn, without errors and failures."""
        return self.plan.before() if self.earth is None else np.array(self.earth.before)


def duration_of(question: Question, kind: str, burn: int, last: float) -> float:
    """Length of a case's drift from the planned time of its burn, s: the horizon, after a burn that ends ``last`` s
    late, and at least until the next burn, which may be late."""
    times, late = [made.time for made in question.plan.burns], question.failures.late
    if kind == "start":
        return max(question.horizon, late)
    # Sums are rounded up.
    whole = (question.horizon + last) * _UP if last > 0.0 else question.horizon
    if kind == "made" and burn + 1 < len(times):
        return max(whole, (times[burn + 1] - times[burn] + late) * _UP)
    return whole


def longest_drift(question: Question, burn: int) -> float:
    """The longest drift of all cases of a burn, s."""
    failures, lasts = question.failures, question.plan.burns[burn].duration
    late = failures.late + lasts + failures.stuck if lasts > 0.0 else max(failures.late, failures.stuck)
    # Sums of a few numbers in another order differ by their rounding.
    lasting = duration_of(question, "late", burn, late * _UP**4)
    return max(duration_of(question, "made", burn, lasts), lasting)

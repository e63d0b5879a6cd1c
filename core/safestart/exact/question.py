"""The exact questions; face distances are affine functions of the start and the thrust history.

Question `stay`: does any thrust history, held over intervals of dt and of norm at most a_max, keep the chaser in the
rotating corridor at ALL times of [0, T]? The corridor is polyhedral at every instant and CWH is linear, so for a
start x0 and thrusts u the distance to face i at time t, slack / |A_i| in metres, is

    f_i(t) = offset_i + start_i(t) . x0 + sum_k thrust_ik(t) . u_k.

Question `synchronize` (with a :class:`Goal`): in addition, at T the chaser is at rest in the body frame in a ball
around the hold point; T is any number of intervals from ``goal.earliest`` to ``steps``. A speed limit adds |v| <= v_max
at all times. These are norms of affine functions (:mod:`safestart.exact.limits`): convex as well.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from safestart.constraints.corridor import corridor_of
from safestart.errors import invalid
from safestart.model.scenario import MAX_RANGE, Scenario, number
from safestart.optim.thrust_shapes import BALL, UnitSet

MAX_STEPS = 400
MAX_TIME = 3600.0
SPEED_SCALE = 10.0
"""Seconds that convert a speed margin into metres: 0.1 m/s below the limit counts as 1 m."""


@dataclass(frozen=True, slots=True)
class Goal:
    """The end of `synchronize`: a ball of ``radius`` metres around ``hold`` (body frame, m), at rest to ``rest`` m/s.

    ``hold`` None is the hold point of the corridor, (0, r_h) or (0, r_h, 0). The speed is relative to the rotating body
    frame; radius / rest seconds convert it into metres, so that both limits give one margin. ``earliest`` is the first
    step at which the flight may end; equal to the question's ``steps`` it fixes T.
    """

    radius: float = 0.5
    rest: float = 0.05
    hold: tuple[float, ...] | None = None
    earliest: int = 1

    def __post_init__(self) -> None:
        number("radius", self.radius, 1e-3, 1000.0)
        number("rest", self.rest, 1e-4, 100.0)

    @property
    def scale(self) -> float:
        """Seconds that convert the speed at the end into metres."""
        return self.radius / self.rest


class Spanned:
    """What the questions in the plane and in space share: ``steps`` intervals of ``dt`` seconds, end and limits."""

    __slots__ = ()
    dt: float
    steps: int
    goal: Goal | None
    speed_limit: float | None

    @property
    def kind(self) -> str:
        """``stay`` or ``synchronize``."""
        return "stay" if self.goal is None else "synchronize"

    @property
    def plain(self) -> bool:
        """Whether this is `stay` without a speed limit, so that only faces count."""
        return self.goal is None and self.speed_limit is None

    @property
    def horizon(self) -> float:
        """T in seconds, or its bound."""
        return self.steps * self.dt

    @property
    def latest(self) -> float:
        """The last double not after the exact T; no time in a proof exceeds it."""
        time = self.horizon
        while Fraction(time) > Fraction(self.dt) * self.steps:
            time = math.nextafter(time, 0.0)
        return time

    def check_span(self) -> None:
        """Raise ``InvalidInput`` for intervals that are too many or too long, or a speed limit that is none."""
        number("dt", self.dt, 0.0, MAX_TIME, open_low=True)
        check_steps("steps", self.steps, MAX_STEPS)
        number("horizon", self.horizon, 0.0, MAX_TIME, open_low=True)
        if self.speed_limit is not None:
            number("speed_limit", self.speed_limit, 1e-3, 1000.0)


@dataclass(frozen=True, slots=True)
class Question(Spanned):
    """Horizon of ``steps`` intervals of ``dt`` seconds; ``dimensions`` 2 (in the orbit plane) or 3.

    ``goal`` makes it `synchronize`. ``speed_limit`` (m/s) holds for the LVLH velocity at all times. ``keep_out`` (m) is
    a radius around the target's centre that the hold plane must imply.
    """

    scenario: Scenario
    dt: float = 2.0
    steps: int = 30
    dimensions: int = 2
    goal: Goal | None = None
    speed_limit: float | None = None
    keep_out: float = 0.0

    def __post_init__(self) -> None:
        self.check_span()
        if self.dimensions not in (2, 3):
            raise invalid("dimensions", "2 or 3", self.dimensions)
        number("keep_out", self.keep_out, 0.0, MAX_RANGE)
        if self.keep_out > self.scenario.corridor.hold_radius:
            raise invalid(
                "keep_out",
                f"at most the hold radius {self.scenario.corridor.hold_radius:g} m, where the hold plane implies it "
                "(the corridor less a larger ball is not convex and has no such proofs: raise the hold radius instead)",
                self.keep_out,
            )
        if self.goal is not None:
            check_steps("earliest", self.goal.earliest, self.steps)
            corridor = corridor_of(self.scenario.corridor, self.dimensions)
            if len(self.hold) != self.dimensions or not bool(corridor.contains(np.array(self.hold))):
                raise invalid("hold", f"{self.dimensions} coordinates of a point of the corridor", self.hold)

    @property
    def thrust_scale(self) -> float:
        """a_max: thrusts are this many times a point of ``thrust_set``, m/s^2."""
        return self.scenario.chaser.max_acceleration

    @property
    def thrust_set(self) -> UnitSet:
        """The unit ball."""
        return BALL

    @property
    def channels(self) -> int:
        """Numbers that make one thrust."""
        return self.dimensions

    @property
    def largest_thrust(self) -> float:
        """Largest size of a thrust, m/s^2."""
        return self.scenario.chaser.max_acceleration

    @property
    def hold(self) -> tuple[float, ...]:
        """The hold point in the body frame, m."""
        if self.goal is not None and self.goal.hold is not None:
            return self.goal.hold
        return (0.0, self.scenario.corridor.hold_radius, 0.0)[: self.dimensions]


def check_steps(name: str, value: int, most: int) -> None:
    """Raise ``InvalidInput`` unless ``value`` is an integer in [1, most]."""
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= most:
        raise invalid(name, f"an integer in [1, {most}]", value)

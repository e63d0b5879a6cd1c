"""A family of questions: tumble rate, thrust limit and mean motion in intervals, the start in a box.

We know a target's values only as intervals: its tumble rate is an estimate, the engines' thrust varies, and navigation
has errors. A verdict for the family holds for every member:

GO      one thrust history stays for every member (witness ``common``), or every corner of the start box has a history
        that stays for every parameter (``per_corner``; the viable starts are convex, so each start between has one,
        the same mixture of the corners' histories, but it must be known when it is flown).
NO_GO   no history stays, for any member: each may have its own history, none helps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from safestart.errors import invalid
from safestart.exact.question import Question
from safestart.model.scenario import (
    MAX_MEAN_MOTION,
    MAX_TUMBLE_RATE,
    MIN_ACCELERATION,
    Chaser,
    Floats,
    Target,
    number,
)

Interval = tuple[float, float]
MAX_HALF_WIDTH = 1000.0


@dataclass(frozen=True, slots=True)
class Family:
    """All questions within half-widths of ``question``: ``tumble_rate`` and ``mean_motion`` (rad/s), thrust (m/s^2).

    ``start`` holds the half-widths of the start box along the LVLH axes, (2 d,): position (m), then velocity (m/s);
    empty: the start is known. An interval may not reach below 0 (thrust: below 1e-6 m/s^2).
    """

    question: Question
    tumble_rate: float = 0.0
    max_acceleration: float = 0.0
    mean_motion: float = 0.0
    start: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if not self.question.plain:
            raise invalid("question", "stay without a speed limit", self.question.kind)
        target, chaser = self.question.scenario.target, self.question.scenario.chaser
        for name, value, least, most in (
            ("tumble_rate", target.tumble_rate, 0.0, MAX_TUMBLE_RATE),
            ("mean_motion", target.mean_motion, 0.0, MAX_MEAN_MOTION),
            ("max_acceleration", chaser.max_acceleration, MIN_ACCELERATION, np.inf),
        ):
            room = min(value - least, most - value)
            number(f"{name}_half_width", getattr(self, name), 0.0, room)
        size = 2 * self.question.dimensions
        if len(self.start) not in (0, size):
            raise invalid("start_half_width", f"{size} numbers or none", self.start)
        for value in self.start:
            number("start_half_width", value, 0.0, MAX_HALF_WIDTH)

    @property
    def rates(self) -> Interval:
        """Tumble rates, rad/s."""
        return _around(self.question.scenario.target.tumble_rate, self.tumble_rate)

    @property
    def motions(self) -> Interval:
        """Mean motions, rad/s."""
        return _around(self.question.scenario.target.mean_motion, self.mean_motion)

    @property
    def thrusts(self) -> Interval:
        """Thrust limits, m/s^2."""
        return _around(self.question.scenario.chaser.max_acceleration, self.max_acceleration)

    @property
    def half(self) -> Floats:
        """Half-widths of the start box, (2 d,)."""
        return np.array(self.start) if self.start else np.zeros(2 * self.question.dimensions)

    def member(self, rate: float, motion: float, thrust: float) -> Question:
        """The question with these values."""
        scenario = replace(self.question.scenario, target=Target(rate, motion), chaser=Chaser(thrust))
        return replace(self.question, scenario=scenario)

    def at_known_start(self) -> Family:
        """Copy the parameters with a start that is known exactly."""
        return replace(self, start=())


def corner_signs(half: Floats) -> Floats:
    """Corners of a box as signs (P, 2 d): +-1 along the axes that have a width, 0 along the others."""
    wide = np.nonzero(half > 0.0)[0]
    out = np.zeros((2 ** len(wide), len(half)))
    out[:, wide] = 1.0 - 2.0 * (np.arange(len(out))[:, None] >> np.arange(len(wide)) & 1)
    return out


def _around(value: float, half: float) -> Interval:
    return (value - half, value + half)

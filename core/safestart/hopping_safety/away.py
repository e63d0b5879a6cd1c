"""The least drift away from the target with which every hop of an approach is proved at a demanded error level.

A hop of Algorithm 1 on the V-bar closes: after a failure it comes back to where it began, and errors decide on which
side of the target it passes. Flown in another time between the same two points it leaves with another along-track
velocity, and its free drift advances by

    D = -6 pi (2 x + vy / n)    metres per orbit (CWH, the secular term of y),

so the time of a hop sets how far each turn of the drift goes. Hops are taken in their order, as the time of one changes
the impulse, and with it the errors, of the next.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from safestart.dynamics.cwh import transition_matrix
from safestart.hopping.approach import Approach, departure, line, with_phases
from safestart.missed_burn.cases import cases_of
from safestart.missed_burn.plan import Errors, Plan, Question
from safestart.missed_burn.prove import bound, slack_of
from safestart.model.scenario import Floats

_STEP = 0.01
"""Hop times are tried in steps of this share before the least one is closed in on."""
_FURTHEST = 0.4
"""Hop times are changed by up to this share."""
_ACCURACY = 1e-4


@dataclass(frozen=True, slots=True)
class Away:
    """The approach that is proved, and the drift that was added to each hop's, (hops,), m per orbit."""

    approach: Approach
    added: Floats


def drift_per_orbit(mean_motion: float, state: Floats) -> float:
    """D, m along-track per orbit, of a state (6,) LVLH that drifts."""
    return float(-6.0 * math.pi * (2.0 * state[0] + state[4] / mean_motion))


@dataclass(frozen=True, slots=True)
class _Leg:
    """One hop to be timed: from ``begin`` (3,), m, where the chaser arrives with ``arrived`` (3,), m/s, to ``end``."""

    mean_motion: float
    begin: Floats
    end: Floats
    time: float
    arrived: Floats

    def left_with(self, factor: float) -> Floats:
        """State (6,) after the impulse of the hop flown in ``factor`` times its time."""
        velocity = departure(self.mean_motion, factor * self.time, self.begin, self.end)
        return np.concatenate([self.begin, velocity])

    def drift(self, factor: float) -> float:
        """Drift along the track, m per orbit, after the impulse of :meth:`left_with`."""
        return drift_per_orbit(self.mean_motion, self.left_with(factor))

    def proved(self, factor: float, keep_out: float, horizon: float, errors: Errors) -> bool:
        """Whether the drift after its impulse keeps out, whatever the errors."""
        before = np.concatenate([self.begin, self.arrived])
        impulse = self.left_with(factor)[3:] - self.arrived
        plan = Plan.of(self.mean_motion, before.tolist(), [0.0], impulse[None])
        question = Question(plan, keep_out, max(horizon, factor * self.time), errors)
        made = next(case for case in cases_of(question) if case.kind == "made")
        return bound(made, question, keep_out + slack_of(question)).least >= keep_out

    def outwards(self) -> float:
        """+1 or -1: in longer or in shorter times the drift, or where it closes the one ahead of the target, grows."""
        planned, longer = self.drift(1.0), self.drift(1.0 + _STEP)
        # A hop that closes drifts by rounding alone: away is then the side it is on.
        side = planned if abs(planned) > 1e-3 * abs(longer - planned) else float(self.begin[1])
        return math.copysign(1.0, (longer - planned) * side)


def least_away(plan: Approach, keep_out: float, horizon: float, errors: Errors) -> Away | None:
    """The approach with every hop proved to keep out under ``errors`` by the least drift away; None without one.

    ``keep_out`` m, ``horizon`` s of drift after each hop's impulse, CWH motion. A hop that is proved as planned keeps
    its time. The search changes a hop's time by up to 40 % in the direction in which its drift grows, in steps of 1 %,
    and closes in on the first time that is proved, to 0.01 %.
    """
    n, along = plan.mean_motion, line(plan.angle_deg)
    arrived, phases, added = np.zeros(3), [], []
    for hop in plan.hops:
        leg = _Leg(n, hop.start * along, hop.end * along, hop.time, arrived)

        def holds(factor: float, leg: _Leg = leg) -> bool:
            return leg.proved(factor, keep_out, horizon, errors)

        factor = 1.0 if holds(1.0) else _least(holds, leg.outwards())
        if factor is None:
            return None
        phases.append(factor * hop.phase)
        added.append(abs(leg.drift(factor) - leg.drift(1.0)))
        arrived = (transition_matrix(n, factor * hop.time) @ leg.left_with(factor))[3:]
    d = np.array([plan.hops[0].start, *(hop.end for hop in plan.hops)])
    return Away(with_phases(n, plan.angle_deg, d, np.array(phases)), np.array(added))


def _least(holds: Callable[[float], bool], direction: float) -> float | None:
    """The factor nearest to 1 that holds, among those tried; None without one."""
    short = 0.0
    for k in range(1, round(_FURTHEST / _STEP) + 1):
        enough = k * _STEP
        if holds(1.0 + direction * enough):
            break
        short = enough
    else:
        return None
    while enough - short > _ACCURACY:
        middle = 0.5 * (short + enough)
        short, enough = (short, middle) if holds(1.0 + direction * middle) else (middle, enough)
    return 1.0 + direction * enough

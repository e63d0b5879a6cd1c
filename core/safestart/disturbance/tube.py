"""The tube: staying in the corridor against any bounded acceleration disturbance.

Truth: CWH with thrust u and a disturbance w(t), |w(t)| <= w_max, any measurable history (a disk in the plane, a ball
in space); the start is known to within balls of position and velocity. Plan: z without disturbance from the known
start. The flown thrust is u_k = v_k + K (x_k - z_k), held over the interval. The error x - z stays in a set that does
not depend on the plan. So a plan that stays in the corridor tightened by that set, with thrust reduced by the most that
K can demand, holds for every disturbance (Mayne, Seron and Rakovic 2005).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from safestart.disturbance.ancillary import LONGEST_INTERVAL, reach_of
from safestart.errors import invalid
from safestart.exact.answer import TOLERANCE, Answer, Verdict
from safestart.exact.decide import decide
from safestart.exact.question import Question
from safestart.model.scenario import MIN_ACCELERATION, Chaser, CorridorShape, Floats, Scenario, number

MAX_DISTURBANCE = 1.0
SETTLE_INTERVALS = (2.5, 5.0, 10.0, 20.0)
"""Time constants of the feedback in intervals. Of 2 s, a disturbance of 1 m/s^2 takes 36.2 m and 1.58 m/s^2 at the
first, 126 m and 1.50 at the second; a start error of 1 m takes 0.030 and 0.0087 m/s^2."""
_WORTH_M = 25.0
"""Radius that counts as much as the whole thrust in the choice of a time constant."""


@dataclass(frozen=True, slots=True)
class Disturbance:
    """Bounds: ``acceleration`` (m/s^2) at all times, and the error of the known start.

    ``position`` (m) and ``velocity`` (m/s) are Euclidean; of both the plan knows only the centre.
    """

    acceleration: float
    position: float = 0.0
    velocity: float = 0.0

    def __post_init__(self) -> None:
        number("disturbance.acceleration", self.acceleration, 0.0, MAX_DISTURBANCE)
        number("disturbance.position", self.position, 0.0, 1000.0)
        number("disturbance.velocity", self.velocity, 0.0, 10.0)

    def vector(self) -> Floats:
        """(3,): acceleration, position, velocity."""
        return np.array([self.acceleration, self.position, self.velocity])


@dataclass(frozen=True, slots=True)
class Tube:
    """The error's bounds, and the scenario that they leave.

    ``radius`` (m) bounds the position error in the plane, ``height`` (m) across it (0 for planar questions), both at
    all times; ``thrust`` (m/s^2) bounds |K e|. ``gain`` (d, 2 d) is K. ``question`` has the tightened scenario; None
    when nothing is left, and ``reason`` says why. ``epsilon`` bounds how far the set exceeds the minimal one.
    """

    radius: float
    height: float
    thrust: float
    gain: Floats
    epsilon: float
    question: Question | None
    reason: str = ""


def tube_of(question: Question, disturbance: Disturbance, settle: float | None = None) -> Tube:
    """Tighten a question; ``settle`` (s) is the feedback's time constant, absent: of 2.5, 5, 10 and 20 intervals the
    one that takes the least (thrust as a share of a_max, 25 m of radius counting as all of it).

    Raises ``InvalidInput`` for intervals longer than 60 s and for a time constant below one interval or above 100.
    """
    if not question.plain:
        raise invalid(
            "question", "stay without a speed limit: the tube tightens the corridor alone", question.kind
        )
    dt = number("dt", question.dt, 0.0, LONGEST_INTERVAL, open_low=True)
    if settle is not None:
        return _tube(question, disturbance, number("settle", settle, dt, 100.0 * dt))
    spread = disturbance.position > 0.0 or disturbance.velocity > 0.0
    tubes = [_tube(question, disturbance, s * dt) for s in SETTLE_INTERVALS[: None if spread else 1]]
    a_max = question.scenario.chaser.max_acceleration
    return min(tubes, key=lambda tube: tube.thrust / a_max + tube.radius / _WORTH_M)


def _tube(question: Question, disturbance: Disturbance, settle: float) -> Tube:
    dt = question.dt
    n, d = question.scenario.target.mean_motion, question.dimensions
    parts = [reach_of(n, dt, settle, part) for part in ("plane", "cross")[: d - 1]]
    bounds = disturbance.vector()
    gain = np.zeros((d, 2 * d))
    radii, thrusts, epsilon = [0.0, 0.0], [0.0, 0.0], 0.0
    for k, reach in enumerate(parts):
        if reach is None:
            reason = f"the feedback with time constant {settle:g} s does not contract"
            return Tube(math.inf, math.inf, math.inf, gain, math.inf, None, reason)
        axes = (0, 1) if k == 0 else (2,)
        gain[np.ix_(axes, [*axes, *(d + a for a in axes)])] = reach.gain
        radii[k], thrusts[k] = float(bounds @ reach.position), float(bounds @ reach.thrust)
        epsilon += disturbance.acceleration * reach.epsilon
    thrust = math.hypot(*thrusts)
    tight, reason = _tighten(question.scenario, radii[0], radii[1], thrust)
    left = None if tight is None else replace(question, scenario=tight)
    return Tube(radii[0], radii[1], thrust, gain, epsilon, left, reason)


def _tighten(scenario: Scenario, radius: float, height: float, thrust: float) -> tuple[Scenario | None, str]:
    """The scenario with less thrust and every face moved in; None and the reason when nothing is left."""
    a_max = scenario.chaser.max_acceleration
    if a_max - thrust < MIN_ACCELERATION:
        return None, f"the feedback may ask for {thrust:.3g} m/s^2, the chaser has {a_max:.3g}"
    shape = scenario.corridor
    hold = shape.hold_radius + radius
    # |A| delta off the offset x0 - c r_h of a side, while r_h itself has grown by the radius.
    x0 = shape.x0 - math.hypot(1.0, shape.c_x) * radius + shape.c_x * radius
    # A z face has the normal (0, -c_z, +-1): the moved hold plane already covers the radius.
    z0 = shape.z0 - height
    # Sides that meet above the hold plane: the plane moves up to where they meet, and the set is the same.
    rise = max(0.0, -x0 / shape.c_x, -z0 / shape.c_z)
    x0, z0, hold = x0 + shape.c_x * rise, z0 + shape.c_z * rise, hold + rise
    if hold > 1000.0:
        return None, f"the error of {radius:.3g} m leaves no corridor within 1 km"
    tight = CorridorShape(shape.c_x, shape.c_z, max(x0, 0.0), max(z0, 0.0), hold)
    return Scenario(scenario.target, Chaser(a_max - thrust), tight), ""


def decide_disturbed(
    question: Question,
    state: Floats,
    disturbance: Disturbance,
    *,
    tolerance: float = TOLERANCE,
    verdict_only: bool = False,
    settle: float | None = None,
) -> Answer:
    """Can this start stay whatever the disturbance does? ``state`` (2 d,) as for :func:`~.exact.decide`.

    GO: the tightened question is GO; ``thrust`` is the plan v, ``lower`` the distance that the disturbed flight keeps
    to every face of the real corridor. NO_GO: even without disturbance no thrust history stays (a disturbance may be
    0, so this holds for every feedback). Otherwise UNDECIDED: another feedback might succeed.
    """
    tube = tube_of(question, disturbance, settle)
    lower, reason = -math.inf, tube.reason
    if tube.question is not None:
        planned = decide(tube.question, state, tolerance=tolerance, verdict_only=verdict_only)
        if planned.verdict is Verdict.GO:
            # The undisturbed best margin bounds the disturbed one; the tightened program does not bound it.
            return replace(planned, upper=math.inf)
        lower, reason = (
            planned.lower,
            f"no plan fits the tube of {tube.radius:.3g} m and {tube.thrust:.3g} m/s^2",
        )
    nominal = decide(question, state, tolerance=tolerance, verdict_only=verdict_only)
    if nominal.verdict is Verdict.NO_GO:
        return nominal
    return Answer(Verdict.UNDECIDED, math.nan, lower, nominal.upper, None, (), nominal.iterations, reason)

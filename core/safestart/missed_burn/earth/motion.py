"""The motion about the true Earth: two bodies with J2, the target on an orbit of any eccentricity.

Every drift has a reference: the flight of the planned state, integrated like the target. A state of a case is off from
it by some q, inertial axes, with q'' = G(t) q + w, G the gradient of gravity along the reference, and the remainder

    |w| <= (3 mu / (r - rho)^4 + 30 mu J2 R^2 / (r - rho)^6) rho^2,     rho = |q|:

the k-th derivative of 1/r along unit vectors is at most k!/r^(k+1), and the potential of J2 is -mu J2 R^2/2 times the
second derivative of 1/r along the Earth's axis. So J2, the eccentricity and the distance to the target are in the
reference and in G; the only disturbance is of second order in the errors. G's transition is integrated with it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from safestart.dynamics.two_body import J2
from safestart.dynamics.two_body_kernel import (
    STAGES,
    WEIGHTS,
    drifted,
    frame_of,
    placed,
    pushed,
    seen,
    target_with,
)
from safestart.errors import invalid
from safestart.missed_burn.earth.frame import Turning, frames_along, turning_of
from safestart.missed_burn.kernels.strays import influence_of
from safestart.missed_burn.kernels.variation import carried, course_of
from safestart.missed_burn.plan import Plan, Question, longest_drift
from safestart.model.orbit import EARTH_RADIUS as RADIUS
from safestart.model.orbit import MAX_ECCENTRICITY, MU
from safestart.model.scenario import Floats, number

PARTS = 96
PER_PART = 16
GRID = PARTS * PER_PART
_LOWER = 0.995
"""The checker finds the least radius by intervals, and so a little lower."""
_STEP = 10.0
"""Longest step of the integration over a part of a drift, s."""
_PULSES = 256
Six = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Earth:
    """``target`` (6,): its inertial state, m and m/s, at the first burn; ``before`` (K, 6): LVLH states of the chaser
    before every burn, around which the box of errors lies."""

    target: Six
    before: tuple[Six, ...]

    @classmethod
    def of(
        cls,
        plan: Plan,
        semi_major_axis: float,
        eccentricity: float = 0.0,
        inclination: float = 0.0,
        perigee: float = 0.0,
        anomaly: float = 0.0,
        before: Floats | None = None,
    ) -> Earth:
        """From the osculating elements at the first burn, m and rad: ``perigee`` is its argument, ``anomaly`` the true
        one. Without ``before`` the plan is flown in this motion, without errors."""
        number("eccentricity", eccentricity, 0.0, MAX_ECCENTRICITY)
        lowest = semi_major_axis * (1.0 - eccentricity)
        if not lowest > RADIUS:
            raise invalid("eccentricity", f"a perigee above the Earth's surface, {RADIUS:g} m", lowest)
        target = target_with(semi_major_axis, eccentricity, inclination, perigee, anomaly)
        if before is None:
            before = flown_plan(plan, target)
        if before.shape != (len(plan.burns), 6):
            raise invalid("states", f"one state before each of {len(plan.burns)} burns", len(before))
        return cls(tuple(target.tolist()), tuple(tuple(state) for state in before.tolist()))


def flown_plan(plan: Plan, target: Floats) -> Floats:
    """LVLH states (K, 6) before each burn of a plan flown without errors."""
    flight, out, now = placed(target, np.array(plan.start)), [], plan.burns[0].time
    for burn in plan.burns:
        flight, _ = drifted(flight, burn.time - now, STAGES, WEIGHTS)
        out.append(seen(flight))
        flight = burnt(flight, np.array(burn.impulse), burn.duration)
        now = burn.time + burn.duration
    states = np.array(out)
    states[0] = plan.start
    return states


def burnt(flight: Floats, impulse: Floats, duration: float) -> Floats:
    """A flight (12,) after a burn, an LVLH ``impulse`` (3,), m/s, spread evenly over its ``duration``, s."""
    if duration == 0.0:
        flight = flight.copy()
        pushed(flight, impulse)
        return flight
    # The thrust as many small impulses, each in the middle of its time.
    for _ in range(_PULSES):
        flight, _ = drifted(flight, 0.5 * duration / _PULSES, STAGES, WEIGHTS)
        pushed(flight, impulse / _PULSES)
        flight, _ = drifted(flight, 0.5 * duration / _PULSES, STAGES, WEIGHTS)
    return flight


@dataclass(frozen=True, slots=True, eq=False)
class Drift:
    """A reference from one burn on, and the linear motion near it, inertial axes.

    ``target`` and ``chaser`` (6,): at the burn; ``reference`` (6,): their difference; ``path`` (GRID + 1, 3): relative
    position every ``step`` s, ``tables`` (GRID + 1, 6, 6): the transition; ``lift`` (6, 6): an LVLH state at the burn
    as an inertial one; ``stiffness``: bound on |G|, 1/s^2, along both courses; ``lowest``: their least radius, m;
    ``influence`` (2, 2, PARTS + 1, PARTS + 1): norms of the blocks of the transition from the end of a part;
    ``frames`` (GRID + 1, 3, 3): LVLH axes as rows; ``turning``: bounds on how LVLH turns.
    """

    target: Floats
    chaser: Floats
    reference: Floats
    step: float
    path: Floats
    tables: Floats
    lift: Floats
    stiffness: float
    lowest: float
    influence: Floats
    frames: Floats
    turning: Turning

    @property
    def part(self) -> float:
        """Length of a part, s."""
        return self.step * PER_PART


def lift_of(target: Floats) -> Floats:
    """(6, 6): LVLH states to inertial ones relative to the target."""
    rows, omega = np.empty((3, 3)), np.empty(3)
    frame_of(target, rows, omega)
    turn = np.array([[0.0, -omega[2], 0.0], [omega[2], 0.0, -omega[0]], [0.0, omega[0], 0.0]])
    out = np.zeros((6, 6))
    out[:3, :3] = out[3:, 3:] = rows.T
    out[3:, :3] = rows.T @ turn
    return out


def stiffness_of(lowest: float) -> float:
    """Bound on |G|: 2 mu / r^3 + 12 mu J2 R^2 / r^5."""
    return 2.0 * MU / lowest**3 + 12.0 * MU * J2 * RADIUS**2 / lowest**5


def inverse(phi: Floats) -> Floats:
    """Inverse (..., 6, 6) of a transition: it is symplectic."""
    out = np.empty_like(phi)
    out[..., :3, :3] = np.swapaxes(phi[..., 3:, 3:], -1, -2)
    out[..., 3:, 3:] = np.swapaxes(phi[..., :3, :3], -1, -2)
    out[..., :3, 3:] = -np.swapaxes(phi[..., :3, 3:], -1, -2)
    out[..., 3:, :3] = -np.swapaxes(phi[..., 3:, :3], -1, -2)
    return out


def moved(target: Floats, seconds: float) -> tuple[Floats, Floats]:
    """Target's state (6,) and transition (6, 6) after a time."""
    count = max(math.ceil(seconds / _STEP), 1)
    course, tables = carried(target, seconds / count, count, count, STAGES, WEIGHTS)
    return course[-1], tables[-1]


@lru_cache(maxsize=64)
def _target_at(target: Six, times: tuple[float, ...], burn: int) -> Six:
    state = np.array(target)
    for one, two in pairwise(times[: burn + 1]):
        state, _ = moved(state, two - one)
    return tuple(state.tolist())


def target_before(question: Question, burn: int) -> Floats:
    """The target's inertial state (6,) at a burn."""
    assert question.earth is not None
    times = tuple(made.time for made in question.plan.burns)
    return np.array(_target_at(question.earth.target, times, burn))


@lru_cache(maxsize=64)
def drift_of(target: Six, state: Six, longest: float) -> Drift:
    """The drift of the LVLH ``state`` (6,) near a ``target`` (6,), for ``longest`` s."""
    # A little longer than the longest case; the checker's parts are longer by twice as little.
    step, start = longest * (1.0 + 2.0**-31) / GRID, np.array(target)
    inner = max(math.ceil(step / _STEP), 1)
    lift = lift_of(start)
    reference = lift @ np.array(state)
    away = course_of(start, step / inner, GRID * inner, inner, STAGES, WEIGHTS)
    course, tables = carried(start + reference, step / inner, GRID * inner, inner, STAGES, WEIGHTS)
    least = min(np.linalg.norm(c[:, :3], axis=1).min() for c in (away, course))
    lowest = float(least) * _LOWER
    nodes = tables[::PER_PART]
    return Drift(
        target=start,
        chaser=start + reference,
        reference=reference,
        step=step,
        path=course[:, :3] - away[:, :3],
        tables=tables,
        lift=lift,
        stiffness=stiffness_of(lowest),
        lowest=lowest,
        influence=influence_of(np.ascontiguousarray(nodes)),
        frames=frames_along(away),
        turning=turning_of(away, lowest),
    )


def drift_after(question: Question, burn: int, share: float) -> Drift:
    """The reference of cases of a burn: as planned before it, with a ``share`` of the burn as a drift from its planned
    time on."""
    assert question.earth is not None
    k = max(burn, 0)
    state = np.array(question.earth.before[k])
    state += share * question.plan.burns[k].gives(question.plan.mean_motion)
    target = tuple(target_before(question, k).tolist())
    return drift_of(target, tuple(state.tolist()), longest_drift(question, k))

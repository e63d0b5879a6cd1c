"""The verdict on a plan: a proved least distance for every case, a flight that comes too near, or a gap."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from safestart.missed_burn.cases import cases_of
from safestart.missed_burn.earth.bound import earth_bound
from safestart.missed_burn.kernels.drift import FIRST, least_distance
from safestart.missed_burn.plan import Question
from safestart.missed_burn.replay import MemberFlight, flown_of
from safestart.missed_burn.sets import Case
from safestart.missed_burn.strays import strays_of
from safestart.model.scenario import Floats

SLACK = 1e-6
"""Metres subtracted from every claim, which cover the rounding of the sets."""
EARTH_SLACK = 1e-3
"""The same about the true Earth, where the integration of the course has its own error."""
_TOLERANCE = 0.02
_MOST_CELLS = 2048
_TOUCHES = 0.1
"""A member nearer than this, m, ends the search, as a set that contains the target has no positive lower bound."""


class Verdict(StrEnum):
    """PROVED and VIOLATED come with evidence, UNKNOWN with its gap."""

    PROVED = "PROVED"
    VIOLATED = "VIOLATED"
    UNKNOWN = "UNKNOWN"


@dataclass(frozen=True, slots=True)
class Finding:
    """One case and ``zone`` (its number): the least distance lies between ``least`` (proved) and ``nearest`` (of a
    member, m), at ``when`` s.

    ``cells`` (N, 5): the intervals of the proof, begin, end (s after the case's time) and direction. ``trials``: radii
    of the nonlinear motion, m, over equal parts of the drift; empty where the motion is linear.
    """

    case: Case
    least: float
    nearest: float
    when: float
    cells: Floats
    member: Floats
    trials: Floats
    zone: int = 0


@dataclass(frozen=True, slots=True)
class Proof:
    """The verdict on all cases; ``least`` is the least distance proved over them, m."""

    question: Question
    verdict: Verdict
    least: float
    findings: tuple[Finding, ...]
    counter_example: MemberFlight | None

    @property
    def gap(self) -> float:
        """Shortfall of the proved least distance against the keep-out radius, m; 0 without one."""
        return max(self.question.keep_out - self.least, 0.0)


_NO_STRAYS = np.zeros((1, 3))


def prove(question: Question, *, tick: Callable[[int, int], None] | None = None, sharp: bool = True) -> Proof:
    """Prove or refute a plan.

    ``sharp``: bound every case to 2 cm or 0.1 %, otherwise only as tightly as the keep-out radius requires. ``tick``
    receives the progress.
    """
    pairs = [(case, zone) for case in cases_of(question) for zone in range(len(question.zones))]
    findings = []
    enough = np.inf if sharp else question.keep_out + slack_of(question)
    for number, (case, zone) in enumerate(pairs):
        findings.append(bound(case, question, enough, zone))
        if tick is not None:
            tick(number + 1, len(pairs))
    least = min(finding.least for finding in findings)
    if least >= question.keep_out:
        return Proof(question, Verdict.PROVED, least, tuple(findings), None)
    for finding in sorted(findings, key=lambda f: f.nearest):
        if finding.nearest >= question.keep_out:
            break
        flown = flown_of(question, finding.case, finding.member, finding.when)
        if flown.distance(question.radius, question.zones[finding.zone]) < question.keep_out:
            return Proof(question, Verdict.VIOLATED, least, tuple(findings), flown)
    return Proof(question, Verdict.UNKNOWN, least, tuple(findings), None)


def slack_of(question: Question) -> float:
    """What is subtracted from every claim, m."""
    return SLACK if question.earth is None else EARTH_SLACK


def bound(case: Case, question: Question, enough: float, zone: int = 0) -> Finding:
    """Bounds on one case and zone; stops at ``enough`` m."""
    n, body = question.plan.mean_motion, question.zones[zone]
    start = float(np.linalg.norm(case.centre[:3]))
    tolerance = max(_TOLERANCE, 1e-3 * min(start, 100.0))
    if question.earth is not None:
        least, nearest, when, member, cells, trials = earth_bound(
            case, question, body, enough, _TOUCHES, tolerance, _MOST_CELLS
        )
        return Finding(case, max(least - EARTH_SLACK, 0.0), nearest, when, cells, member, trials, zone)
    strays, trials = _NO_STRAYS, np.zeros(0)
    if question.radius is not None:
        strays, trials = strays_of(case, question, question.radius)
    still, still_ends = body.blocks
    least, nearest, when, member, cells, _ = least_distance(
        n,
        case.thrust.begin,
        case.duration,
        case.centre,
        case.columns,
        case.ends,
        -np.array(body.centre),
        still,
        still_ends,
        strays,
        FIRST if case.duration - case.thrust.begin > 0.1 * question.horizon else 1,
        enough,
        _TOUCHES,
        tolerance,
        _MOST_CELLS,
    )
    # With unbounded strays the only bound is 0, as no distance is negative.
    return Finding(
        case, max(least - SLACK, 0.0), nearest, when, cells, member[: len(case.columns)], trials, zone
    )


def greatest_scale(question: Question, *, most: float = 100.0, accuracy: float = 1e-3) -> float:
    """lambda: the largest multiple of the errors, up to ``most``, for which every case is proved; 0 if none is.

    Larger errors include smaller ones, so bisection finds it to a relative ``accuracy``, from below.
    """

    def holds(scale: float) -> bool:
        scaled = replace(question, errors=question.errors.scaled(scale))
        enough = question.keep_out + slack_of(question)
        return all(
            bound(case, scaled, enough, zone).least >= question.keep_out
            for case in cases_of(scaled)
            for zone in range(len(scaled.zones))
        )

    errors = question.errors
    if errors.thrust_share > 0.0:
        most = min(most, 0.99 / errors.thrust_share)
    if errors.thrust_angle > 0.0:
        most = min(most, 0.5 * np.pi / errors.thrust_angle)
    low, high = 0.0, 1.0
    while high < most and holds(high):
        low, high = high, 2.0 * high
    high = min(high, most)
    if low == 0.0:
        low = 1.0
        while not holds(low):
            high, low = low, 0.5 * low
            if low < 1e-3:
                return 0.0
    while high > low * (1.0 + accuracy):
        middle = float(np.sqrt(low * high))
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low

"""The verifier: one question in, one finding per requirement out."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from safestart.passive_safety import requirements
from safestart.passive_safety.flights.falsify import Drifting, Powered, closest, powered_extremes
from safestart.passive_safety.flights.independent_flight import replay
from safestart.passive_safety.model import MAX_SPEED, MAX_THRUST, Mode, System, gain
from safestart.passive_safety.question import Finding, Question, Verdict
from safestart.passive_safety.reach.abort_clock import Clock
from safestart.passive_safety.reach.passive import Drift, prove_drift
from safestart.passive_safety.reach.reach_set import Reach, reach
from safestart.passive_safety.reach.tube import Tube
from safestart.runtime.progress import Context

FAR_LEVEL, NEAR_LEVEL = 4, 5
"""Coarsest bins: 2^4 segments of mode 1 (3.2 min), 2^5 of mode 2 (0.8 and 8 min)."""

_TOLERANCE = 1e-5
"""Least depth (m) of a replayed contact, and its largest delay (min): ten times the error of a replay."""
_HINT_MIN = 0.5
_DEEP = 0.8
"""A counter-example within this multiple of the box's half-width ends the search."""


@dataclass(frozen=True, slots=True)
class Verification:
    """``findings``: separation, thrust, los, velocity (octagon), velocity_disc; ``reach``; wall time ``run_s``."""

    question: Question
    findings: Mapping[str, Finding]
    reach: Reach
    run_s: float


def verify(question: Question, context: Context | None = None, seed: int = 0) -> Verification:
    """Prove or refute every requirement; ``seed`` only affects the search for counter-examples."""
    start = time.perf_counter()
    context = context or Context()
    tubes = reach(question)
    reason = tubes.entry.reason or requirements.stays_in_mode_2(tubes, question.system.guard)
    findings = {"separation": _separation(question, tubes, reason, seed, context)}
    findings |= _powered(question, tubes, reason)
    return Verification(question, findings, tubes, time.perf_counter() - start)


def _separation(question: Question, tubes: Reach, reason: str, seed: int, context: Context) -> Finding:
    if question.window is None:
        return Finding(Verdict.SAFE, limit=question.box, reason="no failure is asked for, so nothing drifts")
    if reason:
        return _searched(question, tubes, question.window, seed, reason, None)
    drift = prove_separation(question, tubes, context)
    if not len(drift.open):
        bound = drift.clearance if np.isfinite(drift.clearance) else None
        margin = None if bound is None else bound - question.box
        return Finding(Verdict.SAFE, bound, margin, question.box, detail={"cells": drift.cells})
    first, last = question.window
    hint = (
        float(np.clip(drift.open[:, 0].min() - _HINT_MIN, first, last)),
        float(np.clip(drift.open[:, 1].max() + _HINT_MIN, first, last)),
    )
    text = f"not proved for {len(drift.open)} cells, aborts from {hint[0]:.1f} to {hint[1]:.1f} min"
    return _searched(question, tubes, hint, seed, text, drift)


def prove_separation(question: Question, tubes: Reach, context: Context | None = None) -> Drift:
    """Passive safety of every start in the window; an ``open`` drift is not proved."""
    assert question.window is not None
    context = context or Context()
    done: list[Drift] = []
    for tube, clock, level in drift_sources(tubes):
        done.append(prove_drift(tube, clock, question.window, question.horizon, question.box, level, context))
    return Drift(
        min(d.clearance for d in done),
        np.concatenate([d.open for d in done]),
        sum(d.cells for d in done),
        gave_up=any(d.gave_up for d in done),
    )


def drift_sources(tubes: Reach) -> list[tuple[Tube, Clock, int]]:
    """Tubes of passive starts, with the clock of their abort times and the level of the coarsest bins."""
    sources = [(tubes.far, tubes.clock, FAR_LEVEL)]
    for branch in tubes.branches:
        sources += [(tube, branch.clock, NEAR_LEVEL) for tube in branch.tubes]
    return sources


def _searched(
    question: Question, tubes: Reach, window: tuple[float, float], seed: int, reason: str, drift: Drift | None
) -> Finding:
    """UNSAFE with the flown counter-example, or UNKNOWN with ``reason``."""
    found = closest(question, window, seed, bracket(tubes), _DEEP * question.box)
    detail = {"closest_found_m": found.max_norm, "cells": 0 if drift is None else drift.cells}
    if found.max_norm < question.box and collides(question, found):
        example = {
            "start": list(found.start),
            "abort_min": found.abort,
            "contact_min": found.time,
            "distance_m": found.max_norm,
        }
        return Finding(Verdict.UNSAFE, None, None, question.box, counter_example=example, detail=detail)
    return Finding(Verdict.UNKNOWN, None, None, question.box, reason, detail=detail)


def collides(question: Question, found: Drifting) -> bool:
    """Whether the replay of a counter-example is inside the box by more than round-off, within the horizon."""
    state = replay(question.system, np.array(found.start), found.abort, found.time)
    inside = bool(np.abs(state[:2]).max() < question.box - _TOLERANCE)
    return inside and found.time <= question.horizon + _TOLERANCE


def _powered(question: Question, tubes: Reach, reason: str) -> dict[str, Finding]:
    proved = {
        "thrust": requirements.thrust(tubes),
        "los": requirements.line_of_sight(tubes),
        "velocity": requirements.speed_octagon(tubes),
        "velocity_disc": requirements.speed_disc(tubes),
    }
    if reason:
        proved = {name: replace(f, verdict=Verdict.UNKNOWN, reason=reason) for name, f in proved.items()}
    doubtful = [name for name, finding in proved.items() if finding.verdict is not Verdict.SAFE]
    if not doubtful:
        return proved
    extremes = powered_extremes(question, bracket(tubes))
    sources = {"thrust": "thrust", "los": "los", "velocity": "speed_octagon", "velocity_disc": "speed"}
    for name in doubtful:
        proved[name] = _refuted(question.system, name, proved[name], extremes[sources[name]])
    return proved


def bracket(tubes: Reach) -> tuple[float, float] | None:
    """Times (min) between which every start is proved to enter mode 2; None without a proof."""
    entry = tubes.entry
    return (entry.first, entry.last) if entry.branches else None


def _refuted(system: System, name: str, finding: Finding, flown: Powered) -> Finding:
    limit = {"thrust": MAX_THRUST, "los": 0.0}.get(name, MAX_SPEED)
    if flown.value > limit + 1e-6 * max(1.0, limit) and violates(system, name, flown, limit):
        example = {"start": list(flown.start), "time_min": flown.time, "value": flown.value}
        return replace(finding, verdict=Verdict.UNSAFE, margin=None, reason="", counter_example=example)
    reason = finding.reason or "the bound exceeds the limit, and no simulated flight does"
    return replace(finding, reason=reason, margin=None)


def violates(system: System, name: str, flown: Powered, limit: float) -> bool:
    """Whether the replay of a powered flight breaks the limit at its time as well."""
    state = replay(system, np.array(flown.start), np.inf, flown.time)
    x, y, vx, vy = state
    if name == "thrust":
        return (
            max(float(np.abs(gain(system.motion(mode)) @ state).max()) for mode in (Mode.FAR, Mode.NEAR))
            > limit
        )
    if name == "los":
        return bool(max(abs(y) + np.tan(np.pi / 6.0) * x, -100.0 - x) > limit)
    if name == "velocity":
        return bool(max(abs(vx), abs(vy), abs(vx + vy) / np.sqrt(2.0), abs(vx - vy) / np.sqrt(2.0)) > limit)
    return bool(np.hypot(vx, vy) > limit)

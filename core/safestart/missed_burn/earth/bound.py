"""Bounds on one case about the true Earth: the linear motion near a reference, and how far the true one strays.

The difference e of both motions has e'' = G e + w. Over a part of length h its pushes w_j, at most W_j, change the
state at the part's end by at most (cosh(k h) - 1)/K W_j in position and sinh(k h)/k W_j in velocity, K = k^2 the bound
on |G|; the transition carries that to all later nodes, and the same functions bound e within a part. W_j is the
remainder at the radius of a trial, which is accepted where the motion that it permits stays inside.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.missed_burn.earth.motion import GRID, PARTS, PER_PART, Drift, drift_after
from safestart.missed_burn.kernels.strays import UNBOUNDED, strays_from
from safestart.missed_burn.kernels.table import images_of, least_between
from safestart.missed_burn.plan import Question
from safestart.missed_burn.sets import Case
from safestart.missed_burn.zone import Zone
from safestart.model.scenario import Floats

_UP = 1.0 + 1e-9


def earth_bound(
    case: Case, question: Question, body: Zone, enough: float, below: float, tolerance: float, most: int
) -> tuple[float, float, float, Floats, Floats, Floats]:
    """Lower bound on the distance to a zone, least distance of a member, its time (s) and coordinates, cells (N, 5), s,
    radii (PARTS,), m."""
    drift = drift_after(question, case.burn, case.share)
    last = min(math.ceil(case.duration / drift.step * _UP), GRID)
    first = min(math.floor(case.thrust.begin / drift.step / _UP), last - 1)
    strays, trials = strays_along(case, question, drift)
    still, still_ends = body.blocks
    # How far the zone's centre and blocks may be from their chords between two nodes: W/8 of their sizes.
    size = float(np.linalg.norm(body.centre)) + body.size
    turn = 0.125 * drift.turning.bend * drift.step**2 * size * _UP
    low, near, when, member, cells = least_between(
        np.ascontiguousarray(drift.path[first : last + 1]),
        np.ascontiguousarray(drift.tables[first : last + 1, :3]),
        case.centre - drift.reference,
        case.columns,
        case.ends,
        0.125 * drift.stiffness * drift.step**2 * _UP,
        np.ascontiguousarray(drift.frames[first : last + 1]),
        -np.array(body.centre),
        still,
        still_ends,
        turn,
        # The stray up to the end of the part that holds each step.
        np.repeat(strays, PER_PART)[first:last],
        enough,
        below,
        tolerance,
        most,
    )
    cells[:, :2] = (cells[:, :2] + first) * drift.step
    return low, near, (first + when) * drift.step, member[: len(case.columns)], cells, trials


def strays_along(case: Case, question: Question, drift: Drift) -> tuple[Floats, Floats]:
    """How far (PARTS,), m, the true motion may be from the linear one in each part, and the trial radii (PARTS,), m."""
    h, k = drift.part, math.sqrt(drift.stiffness)
    curve = 0.125 * drift.stiffness * h * h
    if not curve < 0.9:
        # Such parts say nothing about the motion between their ends, nor such nodes about the course's least radius.
        return np.full(PARTS, UNBOUNDED), np.full(PARTS, UNBOUNDED)
    nodes = images_of(
        np.ascontiguousarray(drift.tables[::PER_PART, :3]),
        case.centre - drift.reference,
        case.columns,
        case.ends,
    )[1]
    reached = _UP * np.maximum(nodes[:-1], nodes[1:]).sum(axis=1) / (1.0 - curve)
    reached += detour(case, question, k) + 1e-6
    grown, slid = math.cosh(k * h), math.sinh(k * h) / k
    by_position = (grown - 1.0) / drift.stiffness
    strays, trials = strays_from(reached, drift.influence, grown, slid, by_position, drift.lowest)
    # What is permitted in a part may be less than in an earlier one, and a cell may span both.
    most: Floats = np.maximum.accumulate(strays)
    return most, trials


def detour(case: Case, question: Question, k: float) -> float:
    """Largest distance, m, of the actual position during a late or lasting burn from its equivalent state's."""
    most, failures = 1.0 + question.errors.thrust_share, question.failures
    if case.thrust.last > 0.0:
        size, whole = question.plan.burns[case.burn].thrust * case.thrust.last, case.last + case.thrust.last
        if case.kind == "stuck":
            whole = case.thrust.last
        return most * size * math.sinh(k * whole) / k * _UP
    if case.kind not in ("late", "stuck"):
        return 0.0
    if case.kind == "late":
        return most * question.plan.burns[case.burn].size * math.sinh(k * case.last) / k * _UP
    return most * failures.acceleration * (math.cosh(k * case.last) - 1.0) / k**2 * _UP

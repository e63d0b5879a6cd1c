"""How far the nonlinear motion may be from the linear one, by a bound on the error of the linearisation.

About a circular orbit of radius r (mu = n^2 r^3) the relative motion is x' = A x + (0, w) with

    |w| <= 3 mu rho^2 / (r - rho)^4         (Lagrange's remainder, rho the distance to the target),

so each axis i of the position differs from the linear one by at most int |row_i(t - s)| |w(s)| ds, row_i the rows of
Phi_pv. rho includes the difference itself. Over each part of the horizon a trial radius is accepted when the motion
that it permits stays inside it; by continuity the true motion then does too.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.missed_burn.kernels.drift import position_rows
from safestart.missed_burn.plan import Question
from safestart.missed_burn.sets import Case
from safestart.model.scenario import Floats

PARTS = 96
UNBOUNDED = 1e30
"""Stands for an unbounded difference, with which nothing can be proved."""

_UP = 1.0 + 1e-12
_TRIALS = 40


def remainder(n: float, r: float, rho: float) -> float:
    """Bound on |w|, m/s^2, up to the distance ``rho`` m; infinite from r/2 on."""
    return _UP * 3.0 * n * n * r**3 * rho * rho / (r - rho) ** 4 if rho < 0.5 * r else math.inf


def strays_of(case: Case, question: Question, r: float) -> tuple[Floats, Floats]:
    """Differences (PARTS, 3), m, up to the end of each part, and the trial radii (PARTS,), m."""
    n, h = question.plan.mean_motion, case.duration / PARTS
    radii = _radii(case, question, h)
    reach = _influence(n, h)
    strays = np.full((PARTS, 3), UNBOUNDED)
    trials = np.full(PARTS, UNBOUNDED)
    pushes = np.zeros(PARTS)
    for k in range(PARTS):
        # All earlier parts act on this one with the lag between them.
        before = reach[k:0:-1].T @ pushes[:k] if k else np.zeros(3)
        least = pushes[k - 1] if k else 0.0
        trial = float(radii[k] + np.linalg.norm(before)) * (1.0 + 1e-9) + 1e-6
        for _ in range(_TRIALS):
            push = max(least, remainder(n, r, trial))
            if not math.isfinite(push):
                return strays, trials
            there = _UP * (before + reach[0] * push)
            needed = float(radii[k] + np.linalg.norm(there))
            if needed < trial:
                break
            trial = needed * (1.0 + 1e-9) + 1e-6
        else:
            return strays, trials
        pushes[k], strays[k], trials[k] = push, there, trial
    return strays, trials


def detour(case: Case, question: Question) -> float:
    """Largest distance, m, of the actual position during a late, lasting or finite burn from its equivalent state's."""
    if case.thrust.last > 0.0:
        size = question.plan.burns[case.burn].thrust * case.thrust.last
        return 2.0 * (case.last + case.thrust.last) * (1.0 + question.errors.thrust_share) * size
    if case.kind not in ("late", "stuck"):
        return 0.0
    most, failures = 1.0 + question.errors.thrust_share, question.failures
    if case.kind == "late":
        return 2.0 * case.last * most * question.plan.burns[case.burn].size
    return 2.0 * case.last * most * failures.acceleration * case.last


def _radii(case: Case, question: Question, h: float) -> Floats:
    """Bounds (PARTS,) on the distance of the linear motion from the target over each part."""
    n = question.plan.mean_motion
    rows = np.empty((PARTS + 1, 3, 6))
    for k in range(PARTS + 1):
        position_rows(n, k * h, rows[k])
    bends = np.zeros((2, 3, 6))
    bends[0, 0, 0], bends[0, 0, 4], bends[0, 1, 3], bends[0, 2, 2] = 3.0 * n * n, 2.0 * n, -2.0 * n, -n * n
    bends[1, 0, 3], bends[1, 1, 0], bends[1, 1, 4], bends[1, 2, 5] = -n, -6.0 * n * n, -4.0 * n, -n
    # |P cos + Q sin| <= hypot(|P|, |Q|), for the centre and every block.
    nodes, swings = _sizes(rows, case).sum(axis=1), np.hypot(*_sizes(bends, case)).sum()
    reached = np.maximum(nodes[:-1], nodes[1:]) + 0.125 * h * h * swings
    radii: Floats = _UP * reached + 1e-6 + detour(case, question)
    return radii


def _sizes(rows: Floats, case: Case) -> Floats:
    """Norms (T, 1 + K) of the images of the centre and of each block under rows (T, 3, 6)."""
    centre: Floats = np.linalg.norm(rows @ case.centre, axis=1)[:, None]
    if not len(case.ends):
        return centre
    squares = ((rows @ case.columns.T) ** 2).sum(axis=1)
    blocks = np.add.reduceat(squares, np.concatenate([[0], case.ends[:-1]]), axis=1)
    sizes: Floats = np.concatenate([centre, np.sqrt(blocks)], axis=1)
    return sizes


def _influence(n: float, h: float) -> Floats:
    """(PARTS, 3): bounds on int |row_i| over [m h, (m + 1) h], the mean of the ends plus the chord's error."""
    tau = n * h * np.arange(PARTS + 1)
    sway, swing = np.sin(tau), 2.0 * (1.0 - np.cos(tau))
    along = 4.0 * sway - 3.0 * tau
    rows = np.stack([np.hypot(sway, swing), np.hypot(swing, along), np.abs(sway)], axis=1) / n
    bends = np.array([2.0, 4.0, 1.0]) * n
    reach: Floats = _UP * (0.5 * h * (rows[:-1] + rows[1:]) + h**3 / 12.0 * bends)
    return reach

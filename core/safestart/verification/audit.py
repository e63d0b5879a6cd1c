"""Audit of a proof: simulated flights and drifts against their sets; the largest excess of any of them."""

from __future__ import annotations

import numpy as np

from safestart.scenario import Floats
from safestart.verification.passive import Clock, cell_positions, flow_steps, make_bins
from safestart.verification.question import Question
from safestart.verification.reach import PROOF, Mutation, Reach
from safestart.verification.simulate import active, crossing_times, drifted
from safestart.verification.tube import Tube

PLANE = np.stack([np.cos(np.arange(16) * np.pi / 8), np.sin(np.arange(16) * np.pi / 8)], axis=1)
"""Directions (16, 2) in which positions are compared."""


def random_starts(question: Question, count: int, seed: int) -> Floats:
    """Starts of the initial set, every third one in a corner."""
    centre, gens = question.set()
    weights = np.random.default_rng(seed).uniform(-1.0, 1.0, (count, len(gens)))
    weights[::3] = np.sign(weights[::3])
    return centre + weights @ gens


def rows_of(seed: int) -> Floats:
    """Directions (r, 4) of the state: the axes, and random mixtures of position and of velocity."""
    random = np.random.default_rng(seed).normal(size=(12, 4)) * [1.0, 1.0, 20.0, 20.0]
    return np.vstack([np.eye(4), -np.eye(4), random])


def excess(tube: Tube, states: Floats, times: Floats, rows: Floats) -> Floats:
    """How far (...,) ``states`` (..., 4) at ``times`` (...) of the tube's clock leave the tube; -inf off its clock."""
    on = (times >= tube.start) & (times <= tube.time(tube.steps)) & (tube.steps > 0)
    segment = np.clip(
        ((np.where(on, times, tube.start) - tube.start) / tube.step).astype(int), 0, tube.steps - 1
    )
    if tube.steps == 0:
        return np.full(times.shape, -np.inf)
    result: Floats = np.where(on, (states @ rows.T - tube.upper(rows)[segment]).max(axis=-1), -np.inf)
    return result


def powered_excess(question: Question, reach: Reach, count: int, seed: int, times_each: int = 40) -> float:
    """Largest excess of ``count`` simulated powered flights, each at ``times_each`` random times."""
    starts = random_starts(question, count, seed)
    end = question.horizon if question.window is None else question.window[1]
    crossing = crossing_times(starts, end)[:, None]
    random = np.random.default_rng(seed + 1)
    half = times_each // 2
    # Half of the times in the transient that follows the crossing.
    soon = np.where(np.isfinite(crossing), crossing, 0.0) + random.uniform(0.0, 1.5, (count, half))
    times = np.minimum(np.concatenate([random.uniform(0.0, end, (count, half)), soon], axis=1), end)
    states = active(starts[:, None, :], crossing, times)
    far = times <= crossing
    rows = rows_of(seed)
    worst = np.where(far, excess(reach.far, states, times, rows), -np.inf).max(axis=1)
    since = np.where(far, -1.0, times - crossing)
    # A start is in the branch of the face that it crossed: in one of them, at all times.
    per_branch = [
        np.maximum(*(excess(tube, states, since, rows).max(axis=1) for tube in branch.tubes()))
        for branch in reach.branches
    ]
    if per_branch:
        worst = np.maximum(worst, np.min(per_branch, axis=0))
    return float(worst.max())


def drift_excess(
    question: Question, reach: Reach, count: int, seed: int, level: int, mutation: Mutation = PROOF
) -> float:
    """Largest excess of ``count`` simulated drifts over their cells: bins of ``level``, coarsest drift pieces."""
    assert question.window is not None
    random = np.random.default_rng(seed)
    starts = random_starts(question, count, seed + 1)
    aborts = random.uniform(*question.window, count)
    crossing = crossing_times(starts, question.window[1] + 1.0)
    states = active(starts, crossing, aborts)
    after = random.uniform(0.0, question.horizon - aborts)
    places = drifted(states, after)
    steps, drift_level = flow_steps(question.horizon), 4
    (branch,) = reach.branches  # One face only: a drift does not tell which face its start crossed.
    clock = Clock(branch.crossing.time, branch.crossing.time_gens, branch.crossing.time_radius)
    worst = -np.inf
    for tube, tube_clock, own in (
        (reach.far, Clock(0.0, np.zeros(0), 0.0), aborts),
        (branch.early, clock, aborts - crossing),
        (branch.late, clock, aborts - crossing),
    ):
        mine = (own >= tube.start) & (own < tube.time(tube.steps))
        mine &= (aborts <= crossing) == (tube is reach.far)
        if not mine.any():
            continue
        segment = ((own[mine] - tube.start) / tube.step).astype(int)
        blocks, pick = np.unique(segment >> level, return_inverse=True)
        bins = make_bins(tube, tube_clock, level, blocks, mutation.bins)
        pieces = (after[mine] / (0.5 * (1 << drift_level))).astype(int)
        centre, gens, box = cell_positions(bins, pick, drift_level, pieces, steps)
        away = places[mine] - centre
        reachable = np.abs(gens @ PLANE.T).sum(axis=1) + box @ np.abs(PLANE.T)
        worst = max(worst, float((away @ PLANE.T - reachable).max()))
        clocks = np.abs(aborts[mine] - bins.time[pick]) - np.abs(bins.time_gens[pick]).sum(axis=1)
        worst = max(worst, float(clocks.max()))
    return worst

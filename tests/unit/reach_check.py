"""Simulated flights against reach tubes: the largest excess of any of them over its set (tests and benchmarks)."""

import numpy as np

from safestart.scenario import Floats
from safestart.verification.passive import Clock, cell_positions, flow_steps, make_bins
from safestart.verification.question import Question
from safestart.verification.reach import PROOF, Mutation, Reach
from safestart.verification.simulate import active, crossing_times, drifted
from safestart.verification.tube import Tube

PLANE = np.stack([np.cos(np.arange(16) * np.pi / 8), np.sin(np.arange(16) * np.pi / 8)], axis=1)


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


def excess(tube: Tube, states: Floats, times: Floats) -> float:
    """Largest amount by which ``states`` (N, 4) at ``times`` (N,) of the tube's clock leave the tube."""
    inside = (times >= tube.start) & (times <= tube.time(tube.steps))
    if not inside.any():
        return -np.inf
    rows = rows_of(5)
    segment = np.minimum(((times[inside] - tube.start) / tube.step).astype(int), tube.steps - 1)
    return float((states[inside] @ rows.T - tube.upper(rows)[segment]).max())


def powered_excess(question: Question, reach: Reach, count: int, seed: int) -> float:
    """Largest excess of ``count`` simulated powered flights, each at 40 random times."""
    starts = random_starts(question, count, seed)
    end = question.horizon if question.window is None else question.window[1]
    crossing = crossing_times(starts, end)[:, None]
    random = np.random.default_rng(seed + 1)
    # Half of the times in the transient that follows the crossing.
    soon = np.where(np.isfinite(crossing), crossing, 0.0) + random.uniform(0.0, 1.5, (count, 20))
    times = np.minimum(np.concatenate([random.uniform(0.0, end, (count, 20)), soon], axis=1), end)
    states = active(starts[:, None, :], crossing, times)
    far = times <= crossing
    worst = excess(reach.far, states[far], times[far])
    since = times - crossing
    for i in np.flatnonzero(np.isfinite(crossing[:, 0])):
        near = ~far[i]
        if near.any():
            per_branch = [
                max(excess(tube, states[i][near], since[i][near]) for tube in branch.tubes())
                for branch in reach.branches
            ]
            worst = max(worst, min(per_branch))
    return worst


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
    (branch,) = reach.branches
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

"""Audit of a proof: compare simulated flights and drifts with their sets; returns the largest excess."""

from __future__ import annotations

import numpy as np

from safestart.model.scenario import Bools, Floats
from safestart.passive_safety.flights.rk8_flights import simulate
from safestart.passive_safety.flights.simulate import active, crossing_times, drifted
from safestart.passive_safety.model import Dynamics
from safestart.passive_safety.question import Question
from safestart.passive_safety.reach.abort_clock import Clock
from safestart.passive_safety.reach.passive import cell_positions, flow_steps, make_bins
from safestart.passive_safety.reach.reach_set import Reach
from safestart.passive_safety.reach.tube import Tube


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


def outside(points: Floats, gens: Floats, box: Floats) -> Floats:
    """How far (N,) ``points`` (N, 2) leave the zonotopes ``gens`` (N, m, 2) with ``box`` (N, 2) around the origin, m.

    The normals of the generators and the axes are all normals of such a polygon, so the result is exact.
    """
    normals = np.concatenate(
        [np.stack([-gens[..., 1], gens[..., 0]], axis=-1), np.broadcast_to(np.eye(2), (len(gens), 2, 2))],
        axis=1,
    )
    length = np.hypot(normals[..., 0], normals[..., 1])
    unit = normals / np.where(length > 0.0, length, 1.0)[..., None]
    reach = np.abs(unit @ gens.transpose(0, 2, 1)).sum(axis=2) + np.einsum("nkj,nj->nk", np.abs(unit), box)
    away = np.abs(np.einsum("nkj,nj->nk", unit, points)) - reach
    result: Floats = np.where(length > 0.0, away, -np.inf).max(axis=1)
    return result


def _powered(question: Question, starts: Floats, crossing: Floats, times: Floats) -> tuple[Floats, Floats]:
    """States (N, T, 4) at ``times`` with the engines on, and the crossings (N, 1), near ``crossing`` (N, 1)."""
    system = question.system
    if system.dynamics is Dynamics.LINEAR:
        return active(system, starts[:, None, :], crossing, times), crossing
    states, entries = simulate(system, starts, np.full(len(starts), np.inf), times)
    return states, entries[:, None]


def _drifted(question: Question, starts: Floats, aborts: Floats, after: Floats) -> tuple[Floats, Floats]:
    """Positions (N, 2) at times ``after`` the abort, and the crossings (N,), inf where the abort came first."""
    system = question.system
    if system.dynamics is Dynamics.LINEAR:
        crossing = crossing_times(system, starts, float(aborts.max()) + 1.0)
        return drifted(system.dynamics, active(system, starts, crossing, aborts), after), crossing
    states, crossing = simulate(system, starts, aborts, (aborts + after)[:, None])
    return states[:, 0, :2], crossing


def powered_excess(question: Question, reach: Reach, count: int, seed: int, times_each: int = 40) -> float:
    """Largest excess of ``count`` simulated powered flights, each at ``times_each`` random times."""
    starts = random_starts(question, count, seed)
    end = question.horizon if question.window is None else question.window[1]
    random = np.random.default_rng(seed + 1)
    half = times_each // 2
    # Half of the times in the transient that follows the crossing.
    # Of the linear motion, which is accurate enough to choose the times.
    crossing = crossing_times(question.system, starts, end)[:, None]
    soon = np.where(np.isfinite(crossing), crossing, 0.0) + random.uniform(0.0, 1.5, (count, half))
    times = np.minimum(np.concatenate([random.uniform(0.0, end, (count, half)), soon], axis=1), end)
    states, crossing = _powered(question, starts, crossing, times)
    far = times <= crossing
    rows = rows_of(seed)
    worst = np.where(far, excess(reach.far, states, times, rows), -np.inf).max(axis=1)
    since = np.where(far, -1.0, times - crossing)
    # A start belongs to the branch of the face that it crossed; at all times it is in at least one branch.
    per_branch = [
        np.max([excess(tube, states, since, rows).max(axis=1) for tube in branch.tubes], axis=0)
        for branch in reach.branches
    ]
    if per_branch:
        worst = np.maximum(worst, np.min(per_branch, axis=0))
    return float(worst.max())


def drift_excess(
    question: Question, reach: Reach, count: int, seed: int, level: int, drift_level: int = 4
) -> float:
    """Largest excess of ``count`` simulated drifts over their cells: bins of ``level``, pieces of ``drift_level``."""
    assert question.window is not None
    random = np.random.default_rng(seed)
    starts = random_starts(question, count, seed + 1)
    aborts = random.uniform(*question.window, count)
    after = random.uniform(0.0, question.horizon - aborts)
    places, crossing = _drifted(question, starts, aborts, after)
    steps = flow_steps(question.horizon)

    def strays(tube: Tube, clock: Clock, own: Floats, on: Bools) -> Floats:
        """Excess (N,) over the cells of one tube; -inf for drifts that do not start from it."""
        out = np.full(count, -np.inf)
        mine = on & (own >= tube.start) & (own < tube.time(tube.steps))
        if not mine.any():
            return out
        segment = ((own[mine] - tube.start) / tube.step).astype(int)
        blocks, pick = np.unique(segment >> level, return_inverse=True)
        bins = make_bins(tube, clock, level, blocks)
        pieces = (after[mine] / (0.5 * (1 << drift_level))).astype(int)
        centre, gens, box = cell_positions(bins, pick, drift_level, pieces, steps)
        apart = outside(places[mine] - centre, gens, box)
        clocks = np.abs(aborts[mine] - bins.time[pick]) - np.abs(bins.time_gens[pick]).sum(axis=1)
        out[mine] = np.maximum(apart, clocks)
        return out

    far = aborts <= crossing
    worst = strays(reach.far, reach.clock, aborts, far)
    per_branch = [
        np.max([strays(tube, branch.clock, aborts - crossing, ~far) for tube in branch.tubes], axis=0)
        for branch in reach.branches
    ]
    if per_branch:
        # A start belongs to the branch of the face that it crossed, so to at least one.
        worst = np.maximum(worst, np.min(per_branch, axis=0))
    return float(worst.max())

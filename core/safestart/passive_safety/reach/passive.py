"""After an abort: is the drift apart from the target for every start, every abort time and every time after it?

Passive starts are grouped in bins: of the abort time in mode 1, of the time since crossing in mode 2 (a set at a fixed
time cannot be pulled back through mode 2, which forgets its past). A bin is one zonotope: interpolation between its two
ends adds one symbol, and the abort time is one more coordinate. A bin and a piece of the time after the abort form a
cell; a cell that is not proved apart is quartered, down to the grid of the tube.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from safestart.model.scenario import Floats
from safestart.passive_safety.model import Mode, Motion
from safestart.passive_safety.reach import chord_error as interpolation
from safestart.passive_safety.reach.abort_clock import Clock
from safestart.passive_safety.reach.flow import flow_table, growth
from safestart.passive_safety.reach.nonlinear import deviation, influence, is_nonlinear
from safestart.passive_safety.reach.rounding import SLACK, UP
from safestart.passive_safety.reach.separation import planar_clearance, timed_clearance
from safestart.passive_safety.reach.tube import Tube
from safestart.runtime.progress import Context

DRIFT_STEP = Fraction(1, 2)
"""Finest piece of the time after the abort, min."""

DRIFT_LEVELS = 4
"""Coarsest piece: 2^4 finest."""

MAX_CELLS = 20_000
"""The proof is given up beyond this many cells of one level."""

FEW_CELLS = 48
"""At most this many doubtful cells get the slower test, with time as third axis, before they are quartered."""

Cells = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Bins:
    """Passive starts of bins: ``centre`` (B, 4), ``gens`` (B, m, 4), clocks ``time`` (B,), ``time_gens`` (B, m).

    ``motion`` is the passive one.
    """

    motion: Motion
    centre: Floats
    gens: Floats
    time: Floats
    time_gens: Floats

    @property
    def earliest(self) -> Floats:
        """Lower bound (B,) on the abort time."""
        spread = np.abs(self.time_gens).sum(axis=1)
        result: Floats = self.time - spread - SLACK * (np.abs(self.time) + spread)
        return result


@dataclass(frozen=True, slots=True)
class Drift:
    """Outcome: ``clearance`` is a proved max-norm distance (m) from the target's centre; ``open`` cells remain.

    ``gave_up``: some of these are not of the finest grid and stay open because they were too many.

    Rows of ``open``: (first, last) abort time, (first, last) time after the abort, min. ``cells`` were tried.
    Rows of ``leaves``: bin level, drift level, bin, piece, and 1 where the cell is proved apart, else 0.
    """

    clearance: float
    open: Floats
    cells: int
    leaves: Cells = field(default_factory=lambda: np.zeros((0, 5), dtype=np.intp))
    gave_up: bool = False


def sweep(low: tuple[Floats, Floats], high: tuple[Floats, Floats], bend: Floats) -> tuple[Floats, Floats]:
    """The motion along a bin, relative to the mean of its ends (centres (B, 4), generators (B, g, 4)).

    One generator (B, 4) for the centre, and a box (B, 4) for the generators and for ``bend``.
    """
    return 0.5 * (high[0] - low[0]), UP * (0.5 * np.abs(high[1] - low[1]).sum(axis=1) + bend)


def make_bins(tube: Tube, clock: Clock, level: int, blocks: Cells) -> Bins:
    """Bins ``blocks`` (B,) of 2^level segments of ``tube``."""
    width = 1 << level
    i = blocks * width
    j = np.minimum(i + width, tube.steps)
    length = np.asarray((j - i) * tube.step, dtype=np.float64)
    low, high = tube.centre[i], tube.centre[j]
    first, last = tube.gens[i], tube.gens[j]
    second = np.stack([tube.second[a:b].max(axis=0) for a, b in zip(i, j, strict=True)])
    bend = interpolation.chord_error(length[:, None], second)
    move, extra = sweep((low, first), (high, last), bend)
    centre, spread = 0.5 * (low + high), 0.5 * (first + last)
    rounded = SLACK * (np.abs(centre) + np.abs(spread).sum(axis=1) + np.abs(move))
    # Remainders do not affect the clock, so they go into the box at no cost.
    known = len(clock.gens)
    extra = UP * (extra + np.abs(spread[:, known:]).sum(axis=1))
    # The deviation in the noise grows along the tube, so the value at the bin's end covers the bin.
    box = UP * (extra + np.maximum(tube.noise[i], tube.noise[j]) + rounded)
    count = len(blocks)
    late = np.zeros((count, 1, 4))
    gens = np.concatenate([spread[:, :known], move[:, None, :], box[:, None, :] * np.eye(4), late], axis=1)
    time_gens = np.zeros((count, known + 6))
    time_gens[:, :known] = clock.gens
    time_gens[:, known] = 0.5 * length
    time_gens[:, -1] = clock.radius
    time: Floats = clock.offset + tube.start + 0.5 * tube.step * (i + j).astype(np.float64)
    return Bins(Motion(Mode.PASSIVE, tube.motion.dynamics), centre, gens, time, time_gens)


def cell_positions(
    bins: Bins, pick: Cells, level: int, blocks: Cells, steps: int
) -> tuple[Floats, Floats, Floats]:
    """Positions of cells: centre (N, 2), generators (N, m + 1, 2), box (N, 2)."""
    width = 1 << level
    table = flow_table(bins.motion, Fraction(0), DRIFT_STEP, steps)
    i = blocks * width
    j = i + width
    both = np.concatenate([bins.centre[:, None, :], bins.gens], axis=1)[pick]
    first = np.matmul(both, table.phi[i, :2].transpose(0, 2, 1))
    last = np.matmul(both, table.phi[j, :2].transpose(0, 2, 1))
    size = np.abs(both).sum(axis=1)
    second = np.abs(np.matmul(both, table.psi[i].transpose(0, 2, 1))).sum(axis=1)
    step = DRIFT_STEP * width
    box = interpolation.chord_error(float(step), second @ growth(bins.motion, step)[:2].T)
    box += 0.5 * np.abs(last[:, 1:] - first[:, 1:]).sum(axis=1)
    noise = np.maximum(np.abs(table.phi[i, :2]), np.abs(table.phi[j, :2]))
    box = UP * box + SLACK * np.matmul(noise, size[:, :, None])[:, :, 0]
    if is_nonlinear(bins.motion):
        box += UP * drift_deviation(bins, steps)[pick, i >> DRIFT_LEVELS]
    middle = 0.5 * (first + last)
    sweep = 0.5 * (last[:, :1] - first[:, :1])
    return middle[:, 0], np.concatenate([middle[:, 1:], sweep], axis=1), box


def drift_deviation(bins: Bins, steps: int) -> Floats:
    """Deviation (B, p, 2) of the position from the linear drift, up to the end of each coarsest piece, m."""
    width = 1 << DRIFT_LEVELS
    piece = DRIFT_STEP * width
    starts = np.abs(flow_table(bins.motion, Fraction(0), piece, steps // width).phi[:-1])
    size = np.abs(bins.centre) + np.abs(bins.gens).sum(axis=1)
    places = UP * np.matmul(growth(bins.motion, piece)[:2], starts) @ size.T
    radius = UP * np.hypot(places[:, 0], places[:, 1]).T
    per_unit = influence(bins.motion, Fraction(0), DRIFT_STEP, steps)[width::width]
    result: Floats = deviation(per_unit, radius)[..., :2]
    return result


def prove_drift(
    tube: Tube,
    clock: Clock,
    window: tuple[float, float],
    horizon: float,
    box: float,
    level: int,
    context: Context,
) -> Drift:
    """Prove every drift from ``tube``, aborted inside ``window``, apart from the box up to ``horizon`` (min).

    ``level``: coarsest bin, 2^level segments of the tube.
    """
    if tube.steps == 0:
        return Drift(np.inf, np.zeros((0, 4)), 0)
    finest = flow_steps(horizon)
    drift_level = DRIFT_LEVELS
    bins_at = (tube.steps + (1 << level) - 1) >> level
    drifts = finest >> drift_level
    cells = np.stack(np.meshgrid(np.arange(bins_at), np.arange(drifts), indexing="ij"), axis=-1).reshape(
        -1, 2
    )
    least, tried = np.inf, 0
    leaves: list[Cells] = []
    while len(cells):
        context.step(tried, tried + len(cells), "drift cells")
        unique, pick = np.unique(cells[:, 0], return_inverse=True)
        bins = make_bins(tube, clock, level, unique)
        start = np.maximum(bins.earliest, window[0])
        after = (cells[:, 1] << drift_level) * float(DRIFT_STEP)
        spread = np.abs(bins.time_gens).sum(axis=1)
        possible = (bins.time - spread <= window[1] + 1e-9) & (bins.time + spread >= window[0] - 1e-9)
        keep = possible[pick] & (after <= horizon - start[pick] + 1e-9)
        cells, pick = cells[keep], pick[keep]
        tried += len(cells)
        if not len(cells):
            break
        centre, gens, wide = cell_positions(bins, pick, drift_level, cells[:, 1], finest)
        clearance = planar_clearance(centre, gens, wide)
        last_level = level == 0 and drift_level == 0
        doubt = np.flatnonzero(clearance <= box)
        if len(doubt) and (last_level or len(doubt) <= FEW_CELLS):
            clock_gens = np.pad(bins.time_gens[pick[doubt]], ((0, 0), (0, 1)))
            timed = timed_clearance(
                centre[doubt], gens[doubt], wide[doubt], bins.time[pick[doubt]], clock_gens, window
            )
            clearance[doubt] = np.maximum(clearance[doubt], timed)
        fail = clearance <= box
        least = min(least, float(clearance[~fail].min(initial=np.inf)))
        leaves.append(_leaves(cells[~fail], level, drift_level, 1))
        cells, pick = cells[fail], pick[fail]
        if last_level or 4 * len(cells) > MAX_CELLS:
            leaves.append(_leaves(cells, level, drift_level, 0))
            still = _rows(bins, pick, cells, drift_level)
            return Drift(least, still, tried, np.concatenate(leaves), bool(len(cells)) and not last_level)
        down, after_down = int(level > 0), int(drift_level > 0)
        cells = _split(cells, down, after_down)
        level, drift_level = level - down, drift_level - after_down
        cells = cells[(cells[:, 0] << level) < tube.steps]
    return Drift(least, np.zeros((0, 4)), tried, np.concatenate([*leaves, _leaves(cells, 0, 0, 1)]))


def _leaves(cells: Cells, level: int, drift_level: int, proved: int) -> Cells:
    marks = np.broadcast_to(np.array([level, drift_level], dtype=np.intp), cells.shape)
    return np.hstack([marks, cells, np.full((len(cells), 1), proved, dtype=np.intp)])


def flow_steps(horizon: float) -> int:
    """Finest pieces that cover the horizon, a whole number of coarsest ones."""
    coarse = 1 << DRIFT_LEVELS
    return -(-int(np.ceil(horizon / float(DRIFT_STEP))) // coarse) * coarse


def _split(cells: Cells, down: int, after_down: int) -> Cells:
    parts = [
        np.stack([(cells[:, 0] << down) + a, (cells[:, 1] << after_down) + b], axis=1)
        for a in range(1 + down)
        for b in range(1 + after_down)
    ]
    return np.concatenate(parts)


def _rows(bins: Bins, pick: Cells, cells: Cells, level: int) -> Floats:
    spread = np.abs(bins.time_gens).sum(axis=1)
    after = (cells[:, 1] << level) * float(DRIFT_STEP)
    length = float(DRIFT_STEP) * (1 << level)
    return np.stack([(bins.time - spread)[pick], (bins.time + spread)[pick], after, after + length], axis=1)

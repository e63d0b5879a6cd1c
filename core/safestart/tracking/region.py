"""The safe-start question of the tracking MPC: the starts at rest that it can fly, and those that any history can.

Starts lie in the plane z = 0 of the body at t = 0: rows y = 0.25 + 0.5 i, x = +-(0.25 + 0.5 j) inside the corridor,
at rest in LVLH. A row's starts of all histories are an interval: two programs with x as a variable.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.control.tracking_mpc.controller import Program
from safestart.control.tracking_mpc.tuning import DockingCorridor
from safestart.model.scenario import Bools, Floats
from safestart.tracking.any_history import FEASIBLE, AnyHistory

SPACING = 0.5


@dataclass(frozen=True)
class Grid:
    """``points`` (S, 3), body axes, by row and then by x; ``row`` (S,) is the row's number."""

    points: Floats
    row: np.ndarray[tuple[int, ...], np.dtype[np.int64]]

    def states(self, attitude: Floats) -> Floats:
        """LVLH states (S, 6) at rest, for the attitude (3, 3) at t = 0."""
        return np.concatenate([self.points @ attitude, np.zeros_like(self.points)], axis=1)


def grid_of(shape: DockingCorridor, rows: int) -> Grid:
    """The starts in ``rows`` rows: 930 in 30 rows of the paper's corridor."""
    points, row = [], []
    for i in range(rows):
        y = 0.25 + SPACING * i
        half = 0.25 + SPACING * np.arange(
            int(np.floor((shape.x0 + y / shape.c_x - 0.25) / SPACING + 1e-9)) + 1
        )
        x = np.concatenate([-half[::-1], half])
        points.append(np.stack([x, np.full(len(x), y), np.zeros(len(x))], axis=1))
        row.append(np.full(len(x), i))
    return Grid(np.concatenate(points), np.concatenate(row).astype(np.int64))


def by_program(program: Program, attitudes: Floats, grid: Grid) -> Bools:
    """(S,): the program has a plan that keeps every row."""
    return program.starts(attitudes, grid.states(attitudes[0]))


def by_any_history(histories: AnyHistory, attitude: Floats, grid: Grid) -> Bools:
    """(S,): some history keeps every row; ``attitude`` (3, 3) is that at t = 0."""
    out = np.zeros(len(grid.points), dtype=bool)
    along = np.concatenate([attitude[0], np.zeros(3)])
    for i in range(int(grid.row[-1]) + 1):
        here = grid.row == i
        base = np.concatenate([grid.points[here][0, 1] * attitude[1], np.zeros(3)])
        ends = histories.extent(base, along)
        if ends is not None:
            x = grid.points[here, 0]
            out[here] = (x >= ends[0] - FEASIBLE) & (x <= ends[1] + FEASIBLE)
    return out

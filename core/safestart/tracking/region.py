"""The safe-start question of the tracking MPC: the starts at rest that it can fly, and those that any history can.

Starts lie in planes of constant z in the body at t = 0: rows y = 0.25 + 0.5 i, x = +-(0.25 + 0.5 j) inside the
corridor, at rest in LVLH. A row's starts of all histories are an interval: two programs with x as a variable. The
controller's are those that its program takes, and of these those from which its loop, flown without errors, arrives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from safestart.control.tracking_mpc.controller import Program
from safestart.control.tracking_mpc.tumble import Tumble
from safestart.control.tracking_mpc.tuning import DockingCorridor
from safestart.errors import invalid
from safestart.model.scenario import Bools, Floats
from safestart.tracking.any_history import FEASIBLE, AnyHistory
from safestart.tracking.noisy_flight import Belief, NoisyFlights

SPACING = 0.5
ARRIVED_M = 0.05
_ROUNDING = 1e-6
"""The flights predict attitudes to 1e-7 rad by their own integrator."""


@dataclass(frozen=True)
class Grid:
    """``points`` (S, 3), body axes, by row and then by x; ``row`` (S,) is the row's number."""

    points: Floats
    row: np.ndarray[tuple[int, ...], np.dtype[np.int64]]

    def states(self, attitude: Floats) -> Floats:
        """LVLH states (S, 6) at rest, for the attitude (3, 3) at t = 0."""
        return np.concatenate([self.points @ attitude, np.zeros_like(self.points)], axis=1)


def grid_of(shape: DockingCorridor, rows: int, layers: Sequence[float] = (0.0,)) -> Grid:
    """The starts in ``rows`` rows of each layer: 930 in 30 rows of the paper's corridor at z = 0.

    Raises ``InvalidInput`` if a layer has no start in the corridor.
    """
    points, row, place = [], [], 0
    for z in layers:
        found = 0
        for i in range(rows):
            y = 0.25 + SPACING * i
            if abs(z) > shape.z0 + y / shape.c_z:
                continue
            half = 0.25 + SPACING * np.arange(
                int(np.floor((shape.x0 + y / shape.c_x - 0.25) / SPACING + 1e-9)) + 1
            )
            x = np.concatenate([-half[::-1], half])
            points.append(np.stack([x, np.full(len(x), y), np.full(len(x), z)], axis=1))
            row.append(np.full(len(x), place))
            place, found = place + 1, found + len(x)
        if not found:
            raise invalid("region.z_m", f"layers with starts inside the corridor in {rows} rows", z)
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
        _, y, z = grid.points[here][0]
        base = np.concatenate([y * attitude[1] + z * attitude[2], np.zeros(3)])
        ends = histories.extent(base, along)
        if ends is not None:
            x = grid.points[here, 0]
            out[here] = (x >= ends[0] - FEASIBLE) & (x <= ends[1] + FEASIBLE)
    return out


def by_flight(
    program: Program, tumble: Tumble, attitudes: Floats, grid: Grid, steps: int, taken: Bools
) -> Bools:
    """(S,): of the starts ``taken``, those whose flight of ``steps`` steps arrives.

    It has a plan in every step, is inside at every node and ends within 5 cm of the port.
    """
    orbit = tumble.mean_motion if tumble.reference == "inertial" else 0.0
    flights = NoisyFlights(program, Belief(np.array(tumble.inertia), orbit), "hard", None)
    frames = np.ascontiguousarray(attitudes[: steps + 1])
    times = program.motion.period * np.arange(steps + 1.0)
    rates = np.ascontiguousarray(tumble.body.angular_velocity(times))
    none, sizes, out = np.zeros((steps + 1, 6)), np.ones(steps), np.zeros(len(taken), dtype=bool)
    starts = grid.states(attitudes[0])
    for s in np.nonzero(taken)[0].tolist():
        done = flights.fly(starts[s], frames, rates, none, sizes)
        out[s] = done.unplanned == 0 and done.least_slack >= -_ROUNDING and done.last_range <= ARRIVED_M
    return out

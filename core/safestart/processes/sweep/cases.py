"""The starts of a shard: operating point, position and number of each."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.campaign.case import uniform_run
from safestart.model.scenario import Chaser, CorridorShape, Floats, Scenario, Target
from safestart.processes.sweep.inputs import SweepInputs
from safestart.processes.sweep.split import DRAWN
from safestart.processes.sweep.study import cells_of, drawn_of

Ints = np.ndarray[tuple[int], np.dtype[np.int64]]


@dataclass(frozen=True, slots=True)
class Cases:
    """M starts of one scenario; ``numbers`` (M,) over the whole sweep, ``cells`` (M,) (-1 outside a grid).

    ``points`` (M, 2), body frame, m.
    """

    omega_t_deg_s: float
    a_max_m_s2: float
    scenario: Scenario
    numbers: Ints
    cells: Ints
    points: Floats


def cases_of(inputs: SweepInputs, pieces: list[list[int]]) -> list[Cases]:
    """The cases of one shard, one entry per scenario."""
    if inputs.distribution != "grid":
        return _drawn(inputs, *pieces[0][1:])
    shape, design, ranges = inputs.corridor.shape(), cells_of(inputs), len(inputs.r0_m)
    out = []
    for point in sorted({cell // ranges for cell, _, _ in pieces}):
        numbers, cells, points = [], [], []
        for cell, first, count in pieces:
            if cell // ranges != point:
                continue
            r0 = design.at(cell)["r0_m"]
            side = uniform_run(inputs.seed, (cell,), first, count, DRAWN)
            angles = _widest(shape, np.array([r0]))[0] * side
            points.append(r0 * np.stack([np.sin(angles), np.cos(angles)], axis=1))
            numbers.append(cell * inputs.cases_per_cell + first + np.arange(count))
            cells.append(np.full(count, cell))
        values = design.at(point * ranges)
        omega, a_max = values["omega_t_deg_s"], values["a_max_m_s2"]
        scenario = scenario_of(inputs, omega, a_max)
        merged = (np.concatenate(numbers), np.concatenate(cells), np.concatenate(points))
        out.append(Cases(omega, a_max, scenario, *merged))
    return out


def _drawn(inputs: SweepInputs, first: int, count: int) -> list[Cases]:
    """Cases with a scenario each."""
    drawn = drawn_of(inputs).parameters(first, count)
    ranges = np.array([values["r0_m"] for values in drawn])
    angles = _widest(inputs.corridor.shape(), ranges) * np.array([values["side"] for values in drawn])
    points = ranges[:, None] * np.stack([np.sin(angles), np.cos(angles)], axis=1)
    none = np.full(1, -1)
    out = []
    for k, values in enumerate(drawn):
        omega, a_max = values["omega_t_deg_s"], values["a_max_m_s2"]
        scenario = scenario_of(inputs, omega, a_max)
        out.append(Cases(omega, a_max, scenario, np.array([first + k]), none, points[k : k + 1]))
    return out


def scenario_of(inputs: SweepInputs, omega: float, a_max: float) -> Scenario:
    """Scenario of a case: deg/s, m/s^2."""
    target = Target(math.radians(omega), inputs.mean_motion_rad_s)
    return Scenario(target, Chaser(a_max), inputs.corridor.shape())


def _widest(shape: CorridorShape, r0: Floats) -> Floats:
    """Largest angle (rad) from the corridor's axis of a point inside it, per range (m)."""
    # Side: r sin(a) - c r cos(a) <= x0 - c r_h; hold plane: r cos(a) >= r_h.
    side = (shape.x0 - shape.c_x * shape.hold_radius) / (r0 * math.hypot(1.0, shape.c_x))
    return np.minimum(
        math.atan(shape.c_x) + np.arcsin(np.clip(side, -1.0, 1.0)),
        np.arccos(np.clip(shape.hold_radius / r0, -1.0, 1.0)),
    )

"""The starts of a shard: operating point, position and number of each."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.model.scenario import Chaser, CorridorShape, Floats, Scenario, Target
from safestart.processes.sweep.spec import SweepInputs
from safestart.processes.sweep.split import DRAWN

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


def cases_of(inputs: SweepInputs, number: int, pieces: list[list[int]]) -> list[Cases]:
    """The cases of one shard, one entry per scenario."""
    if inputs.distribution != "grid":
        return _drawn(inputs, number, *pieces[0][1:])
    shape, out = inputs.corridor.shape(), []
    ranges = len(inputs.r0_m)
    for point in sorted({cell // ranges for cell, _, _ in pieces}):
        numbers, cells, points = [], [], []
        for cell, first, count in pieces:
            if cell // ranges != point:
                continue
            r0 = inputs.r0_m[cell % ranges]
            angles = _widest(shape, np.array([r0]))[0] * _uniform(inputs, cell, first, count)
            points.append(r0 * np.stack([np.sin(angles), np.cos(angles)], axis=1))
            numbers.append(cell * inputs.cases_per_cell + first + np.arange(count))
            cells.append(np.full(count, cell))
        a_max = inputs.a_max_m_s2[point // len(inputs.omega_t_deg_s)]
        omega = inputs.omega_t_deg_s[point % len(inputs.omega_t_deg_s)]
        scenario = scenario_of(inputs, omega, a_max)
        merged = (np.concatenate(numbers), np.concatenate(cells), np.concatenate(points))
        out.append(Cases(omega, a_max, scenario, *merged))
    return out


def _drawn(inputs: SweepInputs, number: int, first: int, count: int) -> list[Cases]:
    """Cases with a scenario each; a Latin hypercube is stratified within its shard."""
    rng = _generator(inputs, number, first)
    if inputs.distribution == "latin_hypercube":
        from scipy.stats.qmc import LatinHypercube

        unit: Any = LatinHypercube(4, rng=rng).random(count)
    else:
        unit = rng.uniform(size=(count, 4))
    low = np.array([min(inputs.omega_t_deg_s), min(inputs.a_max_m_s2), min(inputs.r0_m)])
    high = np.array([max(inputs.omega_t_deg_s), max(inputs.a_max_m_s2), max(inputs.r0_m)])
    values = low + (high - low) * unit[:, :3]
    angles = _widest(inputs.corridor.shape(), values[:, 2]) * (2.0 * unit[:, 3] - 1.0)
    points = values[:, 2:] * np.stack([np.sin(angles), np.cos(angles)], axis=1)
    none = np.full(1, -1)
    return [
        Cases(omega, a_max, scenario_of(inputs, omega, a_max), np.array([first + k]), none, points[k : k + 1])
        for k, (omega, a_max) in enumerate(values[:, :2].tolist())
    ]


def _uniform(inputs: SweepInputs, cell: int, first: int, count: int) -> Floats:
    """Numbers in [-1, 1) of the cell's cases from ``first`` on, each draw from a generator of its own."""
    draws = range(first // DRAWN, -(-(first + count) // DRAWN))
    return np.concatenate([_generator(inputs, cell, n).uniform(-1.0, 1.0, DRAWN) for n in draws])[:count]


def _generator(inputs: SweepInputs, *key: int) -> np.random.Generator:
    return np.random.default_rng([inputs.seed, *key])


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

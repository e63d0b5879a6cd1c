"""The largest margin at finitely many rows: a second-order cone program, its thrusts, and a bound proved by its dual.

Maximise m over thrusts u_k = a_max w_k, |w_k| <= 1, subject to offset_j + start_j . x0 + thrust_j . u >= m.
The dual gives weights lambda >= 0 that sum to 1, and for any such weights no thrust history does better than
sum_j lambda_j (offset + start . x0)_j + a_max sum_k |sum_j lambda_j thrust_jk|.

A norm limit, limit - |y(u)| >= m, is a block of d + 1 such rows, (limit, y(u)), in the second-order cone once m is
taken from the first. Its weights are a vector (lambda, p) of that cone, |p| <= lambda: the same sum bounds the margin.

Rows over thrusts in balls are solved by a compiled method (:mod:`safestart.optim.ball_margin`); what it does not
settle, norms and other thrusters by Clarabel. Which one depends on the program alone, and the bound on neither.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np

from safestart.model.scenario import Floats
from safestart.optim.cone_program import ConeProgram, Ints
from safestart.optim.thrust_ball import INSIDE
from safestart.optim.thrust_shapes import BALL, UnitSet

LEAST_WEIGHT = 1e-10
_USABLE = ("Solved", "AlmostSolved", "InsufficientProgress", "MaxIterations")
# How close (m) the compiled method brings its bracket: what Clarabel's tolerances come to.
FINE_M, COARSE_M = 1e-8, 2e-5

SOLVED_BY: Counter[str] = Counter()
"""Programs of this process: ``compiled``, ``open`` (the compiled method did not settle; Clarabel did it), ``cones``."""


@dataclass(frozen=True, slots=True)
class Solved:
    """Thrust (N, d) in m/s^2 inside the ball, weights (J,), and the dual bound (m) that they prove.

    The weights on the rows that hold m (all but the y of blocks) sum to 1.

    ``thrust`` is None when the solver gave nothing usable; ``status`` is the solver's reason.
    """

    status: str
    thrust: Floats | None = None
    weights: Floats | None = None
    bound: float = np.inf


def solve(
    constant: Floats,
    thrust: Floats,
    a_max: float,
    dimensions: int,
    blocks: int = 0,
    *,
    fine: bool = True,
    within: UnitSet = BALL,
    components: int = 0,
) -> Solved:
    """Solve for J rows: ``constant`` (J,) = offset + start . x0 in m, ``thrust`` (J, N d) in m per m/s^2.

    The last ``blocks`` (d + 1) rows are norm limits. The weights prove their bound at any accuracy; without ``fine``
    the solver stops some iterations earlier, some 1e-5 m from the optimum. With another set ``within`` thrusts are
    a_max times its points, ``dimensions`` its channels, and ``components`` d of the norms.
    """
    if within is BALL and not blocks:
        found = _compiled(constant, thrust, a_max, dimensions, FINE_M if fine else COARSE_M)
        SOLVED_BY["open" if found is None else "compiled"] += 1
        if found is not None:
            return found
    else:
        SOLVED_BY["cones"] += 1
    return solve_by_cones(
        constant, thrust, a_max, dimensions, blocks, fine=fine, within=within, components=components
    )


def _compiled(
    constant: Floats, thrust: Floats, a_max: float, dimensions: int, tolerance: float
) -> Solved | None:
    """Solve by the compiled method; None where it does not settle."""
    # Imported with the first program, because Numba takes a second to load.
    from safestart.optim.ball_margin import SOLVED, largest_margin

    w, weights, status, _ = largest_margin(constant, a_max * thrust, dimensions, tolerance)
    if status != SOLVED:
        return None
    weights[weights < LEAST_WEIGHT * max(1.0, float(np.maximum.reduce(weights)))] = 0.0
    weights /= float(np.add.reduce(weights))
    w = w.reshape(-1, dimensions)
    bounded = BALL.bound(constant, thrust, weights, a_max, dimensions)
    return Solved("Solved", a_max * BALL.repaired(w), weights, bounded)


def solve_by_cones(
    constant: Floats,
    thrust: Floats,
    a_max: float,
    dimensions: int,
    blocks: int = 0,
    *,
    fine: bool = True,
    within: UnitSet = BALL,
    components: int = 0,
) -> Solved:
    """Solve by Clarabel, whatever the program."""
    rows, columns = thrust.shape
    count, cone = columns // dimensions, (components or dimensions) + 1
    plain = rows - blocks * cone
    scaled = a_max * thrust
    program = ConeProgram(thrust=columns, margin=1)
    program.rows("faces", constant[:plain], thrust=scaled[:plain], margin=-1.0)
    if blocks:
        program.norms("limits", constant[plain:].reshape(blocks, cone), thrust=scaled[plain:], margin=-1.0)
    within.keep(program, count, dimensions)
    program.minimise(margin=-1.0)
    found = program.solve(fine=fine)
    if found.status not in _USABLE:
        return Solved(found.status)
    w = found.value("thrust").reshape(count, dimensions)
    weights = found.weights("faces")
    holds: slice | Ints = slice(None)
    if blocks:
        weights = np.concatenate([weights, found.weights("limits")])
        holds = np.concatenate([np.arange(plain), np.arange(plain, rows, cone)])
    # Drop the interior point's small weights on irrelevant rows from the proof and its bound.
    least = LEAST_WEIGHT * max(1.0, float(np.maximum.reduce(weights[holds])))
    weights[:plain][weights[:plain] < least] = 0.0
    if blocks:
        _into_cone(weights[plain:].reshape(blocks, cone), least)
    total = float(np.add.reduce(weights[holds]))
    if not (math.isfinite(np.add.reduce(w, axis=None)) and 0.0 < total < math.inf):
        return Solved(found.status)
    weights /= total
    bounded = within.bound(constant, thrust, weights, a_max, dimensions)
    return Solved(found.status, a_max * within.repaired(w), weights, bounded)


def _into_cone(weights: Floats, least: float) -> None:
    """Weights (B, d + 1) of norm limits, in place: those below ``least`` dropped, the others moved into the cone."""
    weights[weights[:, 0] < least] = 0.0
    norms = np.sqrt((weights[:, 1:] ** 2).sum(axis=1))
    weights[:, 0] = np.maximum(weights[:, 0], norms / INSIDE)

"""The exact question at finitely many rows as a second-order cone program, solved by Clarabel.

Maximise m over thrusts u_k = a_max w_k, |w_k| <= 1, subject to offset_j + start_j . x0 + thrust_j . u >= m.
The dual gives weights lambda >= 0 that sum to 1, and for any such weights no thrust history does better than
sum_j lambda_j (offset + start . x0)_j + a_max sum_k |sum_j lambda_j thrust_jk|.

A norm limit, limit - |y(u)| >= m, is a block of d + 1 such rows, (limit, y(u)), in the second-order cone once m is
taken from the first. Its weights are a vector (lambda, p) of that cone, |p| <= lambda: the same sum bounds the margin.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.model.scenario import Floats

Ints = np.ndarray[tuple[int, ...], np.dtype[np.int64]]

# A hair inside the disk, so that the norm is within a_max in exact arithmetic and not only in floats.
_INSIDE = 1.0 - 1e-14
_LEAST_WEIGHT = 1e-10


@dataclass(frozen=True, slots=True)
class Solved:
    """Thrust (N, d) in m/s^2 inside the disk, weights (J,), and the dual bound (m) that they prove.

    The weights on the rows that hold m (all but the y of blocks) sum to 1.

    ``thrust`` is None where the solver gave nothing usable; ``status`` is its own word for why.
    """

    status: str
    thrust: Floats | None = None
    weights: Floats | None = None
    bound: float = np.inf


def solve(
    constant: Floats, thrust: Floats, a_max: float, dimensions: int, blocks: int = 0, *, fine: bool = True
) -> Solved:
    """Solve for J rows: ``constant`` (J,) = offset + start . x0 in m, ``thrust`` (J, N d) in m per m/s^2.

    The last ``blocks`` (d + 1) rows are norm limits. What is found proves what it proves at any accuracy; without
    ``fine`` the solver stops some iterations earlier, some 1e-5 m from the optimum.
    """
    # Loaded with the first question and not with every import of the certificates.
    import clarabel

    rows, columns = thrust.shape
    count = columns // dimensions
    cone = dimensions + 1
    scaled = a_max * thrust
    size = rows + count * cone
    plain = rows - blocks * cone
    holds = np.concatenate([np.arange(plain), np.arange(plain, rows, cone)])
    a = _columns(scaled, dimensions, size, holds)
    b = np.zeros(size)
    b[:rows] = constant
    b[rows::cone] = 1.0
    cost = np.zeros(columns + 1)
    cost[-1] = -1.0
    cones = [clarabel.NonnegativeConeT(plain), *[clarabel.SecondOrderConeT(cone)] * (blocks + count)]
    none = _Sparse([], [], [0] * (columns + 2), (columns + 1, columns + 1))
    found = clarabel.DefaultSolver(
        none, cost.tolist(), a, b.tolist(), cones, solver_settings(fine=fine)
    ).solve()
    status = str(found.status)
    if status not in ("Solved", "AlmostSolved", "InsufficientProgress", "MaxIterations"):
        return Solved(status)
    w = np.array(found.x[:-1]).reshape(count, dimensions)
    weights = np.array(found.z[:rows])
    # What the interior point leaves on rows that do not matter is not carried into the proof, nor into its bound.
    least = _LEAST_WEIGHT * max(1.0, float(weights[holds].max()))
    weights[:plain][weights[:plain] < least] = 0.0
    if blocks:
        _into_cone(weights[plain:].reshape(blocks, cone), least)
    total = float(weights[holds].sum())
    if not (np.isfinite(w).all() and np.isfinite(total) and total > 0.0):
        return Solved(status)
    weights /= total
    return Solved(status, a_max * into_disk(w), weights, bound(constant, thrust, weights, a_max, dimensions))


def _into_cone(weights: Floats, least: float) -> None:
    """Weights (B, d + 1) of norm limits, in place: those below ``least`` dropped, the others moved into the cone."""
    weights[weights[:, 0] < least] = 0.0
    norms = np.sqrt((weights[:, 1:] ** 2).sum(axis=1))
    weights[:, 0] = np.maximum(weights[:, 0], norms / _INSIDE)


def into_disk(w: Floats) -> Floats:
    """Thrusts (N, d) in units of a_max, those that the solver left a hair outside the unit disk scaled back into it."""
    norms = np.sqrt((w * w).sum(axis=1))
    inside: Floats = w * np.where(norms > _INSIDE, _INSIDE / np.maximum(norms, _INSIDE), 1.0)[:, None]
    return inside


def bound(constant: Floats, thrust: Floats, weights: Floats, a_max: float, dimensions: int) -> float:
    """Largest weighted sum of the rows (m) over all thrust histories: with weights (J,) of sum 1, a margin's bound."""
    pull = (weights @ thrust).reshape(-1, dimensions)
    return float(weights @ constant + a_max * np.sqrt((pull * pull).sum(axis=1)).sum())


class _Sparse:
    """Compressed columns as Clarabel reads them; lists, because it would box every element of an array."""

    has_canonical_format = has_sorted_indices = True

    def __init__(
        self, data: list[float], indices: list[int], indptr: list[int], shape: tuple[int, int]
    ) -> None:
        self.data, self.indices, self.indptr, self.shape = data, indices, indptr, shape


def _columns(scaled: Floats, dimensions: int, size: int, holds: Ints) -> _Sparse:
    """The constraint matrix by columns: (-thrust, then -1 in its cone) for each w, and 1 in the rows that hold m."""
    rows, columns = scaled.shape
    component = np.arange(columns)
    cone = rows + (dimensions + 1) * (component // dimensions) + 1 + component % dimensions
    filled = np.empty((columns, rows + 1))
    filled[:, :rows] = -scaled.T
    filled[:, rows] = -1.0
    where = np.empty((columns, rows + 1), dtype=np.int64)
    where[:, :rows] = np.arange(rows)
    where[:, rows] = cone
    keep = filled != 0.0
    counts = keep.sum(axis=1)
    data = np.concatenate([filled[keep], np.ones(len(holds))])
    indices = np.concatenate([where[keep], holds])
    starts = np.concatenate([[0], np.cumsum(counts), [int(counts.sum()) + len(holds)]])
    return _Sparse(data.tolist(), indices.tolist(), starts.tolist(), (size, columns + 1))


def solver_settings(*, fine: bool = True) -> Any:
    """Clarabel's settings for programs of this size."""
    import clarabel

    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    settings.presolve_enable = False
    settings.chordal_decomposition_enable = False
    settings.iterative_refinement_enable = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-8
    if not fine:
        settings.tol_gap_abs, settings.tol_gap_rel, settings.tol_feas = 2e-5, 1e-7, 1e-6
    return settings

"""The thrust sequence of least impulse that keeps a wanted margin at all times: a cone program with cutting planes."""

from __future__ import annotations

from typing import Any

import numpy as np

from safestart.exact.watch import Ints, Watch
from safestart.model.scenario import Floats
from safestart.optim.conic import into_disk, solver_settings

ROUNDS = 8
# Rows near a local minimum below this share of the wanted margin are added; a plan that keeps it is taken.
ENOUGH = 0.8


def least_fuel(
    watch: Watch, state: Floats, times: Floats, faces: Ints, margin: float
) -> tuple[Floats, float] | None:
    """Thrusts (N, d) in m/s^2 of least total impulse and the margin (m) they keep at all times, about ``margin``.

    ``times`` (J,) and ``faces`` (J,) are the rows to start with. None when the solver failed or the rounds ran out:
    the caller then keeps the plan it has.
    """
    a_max = watch.question.scenario.chaser.max_acceleration
    for _ in range(ROUNDS):
        cuts = watch.cuts(times, faces)
        found = _solve(
            cuts.offset + cuts.start @ state - margin, cuts.thrust, a_max, watch.question.dimensions
        )
        if found is None:
            return None
        minima = watch.minima(state, found)
        if minima.lowest >= ENOUGH * margin:
            return found, minima.lowest
        low = minima.values < 0.5 * (1.0 + ENOUGH) * margin
        if not low.any():
            return None
        times, faces = np.append(times, minima.times[low]), np.append(faces, minima.faces[low])
    return None


def _solve(slack: Floats, thrust: Floats, a_max: float, d: int) -> Floats | None:
    """Minimise sum_k s_k over |w_k| <= s_k <= 1 with slack + a_max thrust . w >= 0, thrusts being a_max w (N, d)."""
    import clarabel
    from scipy.sparse import csc_array

    rows, columns = thrust.shape
    count, cone = columns // d, d + 1
    a = np.zeros((rows + count + count * cone, columns + count))
    b = np.zeros(len(a))
    a[:rows, :columns], b[:rows] = -a_max * thrust, slack
    each = np.arange(count)
    a[rows + each, columns + each], b[rows : rows + count] = 1.0, 1.0
    heads = rows + count + cone * each
    a[heads, columns + each] = -1.0
    for axis in range(d):
        a[heads + 1 + axis, d * each + axis] = -1.0
    cost = np.concatenate([np.zeros(columns), np.ones(count)])
    cones: list[Any] = [clarabel.NonnegativeConeT(rows + count), *[clarabel.SecondOrderConeT(cone)] * count]
    none = csc_array((len(cost), len(cost)))
    found = clarabel.DefaultSolver(none, cost, csc_array(a), b, cones, solver_settings()).solve()
    w = np.array(found.x[:columns])
    if str(found.status) not in ("Solved", "AlmostSolved") or not np.isfinite(w).all():
        return None
    return a_max * into_disk(w.reshape(count, d))

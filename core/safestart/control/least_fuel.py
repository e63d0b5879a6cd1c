"""The thrust sequence of least impulse that keeps a wanted margin at all times: a cone program with cutting planes."""

from __future__ import annotations

import numpy as np

from safestart.exact.watch import Ints, Watch
from safestart.model.scenario import Floats
from safestart.optim.cone_program import ConeProgram, Each
from safestart.optim.thrust_ball import into_balls, keep_in_balls

ROUNDS = 8
# Rows are added near local minima below this share of the wanted margin; a plan that keeps this share is accepted.
ENOUGH = 0.8


def least_fuel(
    watch: Watch, state: Floats, times: Floats, faces: Ints, margin: float
) -> tuple[Floats, float] | None:
    """Thrusts (N, d) in m/s^2 of least total impulse and the margin (m) they keep at all times, about ``margin``.

    ``times`` (J,) and ``faces`` (J,) are the rows to start with. None when the solver failed or the rounds ran out; the
    caller then keeps its plan.
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
    count = thrust.shape[1] // d
    program = ConeProgram(thrust=count * d, impulse=count)
    program.rows("faces", slack, thrust=a_max * thrust)
    program.rows("largest", np.ones(count), impulse=Each(np.arange(count)[:, None], -1.0))
    keep_in_balls(program, count, d, radius="impulse")
    program.minimise(impulse=1.0)
    found = program.solve()
    w = found.value("thrust")
    if not found.solved or not np.isfinite(w).all():
        return None
    return a_max * into_balls(w.reshape(count, d))

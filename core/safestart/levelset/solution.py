"""Solve a level-set problem: march, watch the range of the value, and report an untrustworthy result."""

from __future__ import annotations

import math
import time as clock
from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.errors import invalid
from safestart.levelset.adapter import as_motion
from safestart.levelset.dynamics import Motion
from safestart.levelset.field import ValueField, optimal_inputs
from safestart.levelset.lattice import Lattice
from safestart.levelset.levels import Level
from safestart.levelset.march import March, Options
from safestart.levelset.scheme import Kind, Scheme
from safestart.levelset.walls import beyond_is_outside
from safestart.model.scenario import Floats
from safestart.runtime.progress import Context

MAX_STEPS = 1_000_000
# Share of the initial range by which the value may leave it: rounding for the monotone first-order scheme, over-
# and undershoot (measured: 1 %) for the others. A faulty boundary makes the value leave it several times over.
MONOTONE_TOLERANCE, TOLERANCE = 1e-3, 0.05
LOOKS = 20
MOMENTS = 200
"""Least number of samples, over the horizon, of moving levels and of a time-varying motion."""


@dataclass(frozen=True, slots=True)
class Solution:
    """Value function at the start of the horizon.

    ``field`` is None when the computation failed; ``failure`` then says why. ``steps`` time steps were taken,
    in ``run_s`` seconds of wall time (compilation included when it was the first call).
    """

    lattice: Lattice
    motion: Motion
    time: float
    field: ValueField | None
    failure: str
    steps: int
    run_s: float

    def optimal_inputs(self, states: Floats) -> list[Floats]:
        """Each player's optimal input (..., m) at states (..., n), at the solution's time.

        Raises ``InvalidInput`` for states outside the lattice and when there is no field.
        """
        if self.field is None:
            raise invalid("solution", "a computation that did not fail", self.failure)
        return optimal_inputs(self.motion, self.field.gradient_at(states), states, self.time)


def solve(
    lattice: Lattice,
    dynamics: Any,
    values: Floats,
    horizon: float,
    *,
    kind: Kind | str = Kind.TUBE,
    options: Options | None = None,
    cap: Level | None = None,
    floor: Level | None = None,
    start: float = 0.0,
    context: Context | None = None,
) -> Solution:
    """Value at time ``start`` of the game that is worth ``values`` (shape of the lattice) at ``start + horizon``.

    ``dynamics`` is a motion (:class:`~safestart.levelset.dynamics.Linear`) or a model of hj-reachability's form.
    ``cap`` and ``floor``: see :class:`~safestart.levelset.march.March`; moving ones, and a time-varying motion, are
    sampled at least 200 times over the horizon, a level more often when it changes by more than half a cell. For
    ``always`` the state must stay inside the lattice: a state that has to leave it counts as outside the set. Raises
    ``InvalidInput`` for bad input and for more than a million steps, and ``Cancelled`` when the context says so. A
    value that is not finite, or that leaves its possible range, gives a solution with ``field`` None.
    """
    if not (math.isfinite(horizon) and horizon > 0.0):
        raise invalid("horizon", "a positive number of seconds", horizon)
    values = np.asarray(values, dtype=np.float64)
    if not np.isfinite(values).all():
        raise invalid("values", "finite values", "NaN or infinity")
    context, options = context or Context(), options or Options()
    begin = clock.perf_counter()
    motion = as_motion(dynamics, lattice)
    if Kind(kind) is Kind.ALWAYS and values.shape == lattice.shape:
        values = beyond_is_outside(
            lattice, motion, values, list(np.linspace(start + horizon, start, MOMENTS + 1))
        )
    march = March(
        lattice, motion, values, start + horizon, Kind(kind), options, cap, floor, horizon / MOMENTS
    )
    del values  # of a large grid every copy counts
    try:
        steps = march.rate * horizon / options.courant
        if not steps <= MAX_STEPS:
            raise invalid("lattice", f"a lattice and horizon of at most {MAX_STEPS} steps", steps)
        batch = max(1, min(LOOKS * 5, math.ceil(steps / LOOKS)))
        failure, left = "", horizon
        while left > 0.0 and not failure:
            for _ in range(batch):
                taken = march.step(left)
                left = 0.0 if taken >= left else left - taken
                if left == 0.0:
                    break
            if march.steps > MAX_STEPS:
                raise invalid("lattice", f"a lattice and horizon of at most {MAX_STEPS} steps", march.steps)
            context.step(horizon - left, horizon, "time steps")
            failure = _trouble(march, options, motion)
        field = None if failure else ValueField(lattice, march.result())
    finally:
        march.close()
    return Solution(lattice, motion, start, field, failure, march.steps, clock.perf_counter() - begin)


def _trouble(march: March, options: Options, motion: Motion) -> str:
    """Why the value cannot be trusted, or ""."""
    low, high = march.range()
    if not math.isfinite(low + high):
        return f"the value is not finite at t = {march.time:g} s"
    if any(price > 0.0 for _, _, price in motion.bounds):
        return ""
    least, most = march.allowed
    share = MONOTONE_TOLERANCE if options.scheme is Scheme.FIRST else TOLERANCE
    slack = share * (most - least)
    if low < least - slack or high > most + slack:
        return (
            f"at t = {march.time:g} s the value lies in [{low:.4g}, {high:.4g}], outside the range "
            f"[{least:.4g}, {most:.4g}] that it must keep: the boundary has poisoned it"
        )
    return ""

"""How far the set of starts that can stay extends in a direction: a cone program over start and thrust.

Starts are at rest in LVLH, planar, p = (x, y). Maximise g . p subject to offset_j + start_j . p + thrust_j . u >= e at
the rows so far, |u_k| <= a_max and y <= y_max; rows are added where the proposed flight comes closer, as in `exact`.
The dual weights lambda >= 0 prove, for EVERY start, the affine bound on its margin in metres

    margin(p) <= sum_j lambda_j (offset_j + start_j . p) + a_max sum_k |sum_j lambda_j thrust_jk|,  sum lambda = 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.exact.watch import Watch
from safestart.model.scenario import Floats
from safestart.optim.cone_program import ConeProgram
from safestart.optim.thrust_ball import bound, into_balls, keep_in_balls

CLEARANCE = 1e-3
"""Distance (m) that the witness of a farthest start keeps, so that its proof does not depend on the last digit."""
_ROUNDS = 40
_FIRST_TIMES = 7


@dataclass(frozen=True, slots=True)
class Witness:
    """A start (2,) with thrust (N, 2) that keeps ``margin`` metres at all times."""

    start: Floats
    thrust: Floats
    margin: float


@dataclass(frozen=True, slots=True)
class Ceiling:
    """Bound on every margin: ``slope`` (2,) . p + ``level`` metres, from weights (J,) at times (s) and faces."""

    slope: Floats
    level: float
    times: Floats
    faces: Any
    weights: Floats


class NotSolved(Exception):
    """The cone program gave nothing usable; the message is the solver's status."""


class Extent:
    """The cone programs of one question, planar, starts at rest in LVLH, y at most ``y_max`` metres."""

    def __init__(self, watch: Watch, y_max: float) -> None:
        self.watch, self.y_max = watch, y_max
        self.a_max = watch.question.scenario.chaser.max_acceleration
        faces = len(watch.names)
        times = np.repeat(np.linspace(0.0, watch.question.horizon, _FIRST_TIMES), faces)
        self._base: tuple[Floats, Any] = (times, np.tile(np.arange(faces), _FIRST_TIMES))
        # Rows that bound the last answer; the next direction will touch the corridor at nearly the same times.
        self._active: tuple[Floats, Any] = (np.empty(0), np.empty(0, dtype=np.int64))

    def farthest(self, direction: Floats) -> tuple[Witness, Ceiling | None, float]:
        """Start that keeps ``CLEARANCE`` and lies farthest along the unit ``direction`` (2,), its ceiling, and how far
        any start can lie.

        No ceiling when only y_max limits. Raises :class:`NotSolved`.
        """
        return self._search(direction)

    def deepest(self) -> tuple[Witness, Ceiling | None]:
        """The start with the largest margin, negative when no start can stay. Raises :class:`NotSolved`."""
        return self._search(None)[:2]

    def _search(self, direction: Floats | None) -> tuple[Witness, Ceiling | None, float]:
        watch = self.watch
        times, faces = (np.concatenate(pair) for pair in zip(self._base, self._active, strict=True))
        for _ in range(_ROUNDS):
            cuts = watch.cuts(times, faces)
            start, thrust, margin, weights, reach = self._solve(
                cuts.offset, cuts.start[:, :2], cuts.thrust, direction
            )
            minima = watch.minima(np.concatenate([start, [0.0, 0.0]]), thrust)
            wanted = CLEARANCE if direction is not None else margin
            low = minima.values < wanted - 0.25 * CLEARANCE
            if minima.lowest >= wanted - 0.5 * CLEARANCE or not low.any():
                active = weights > 1e-9 * weights.sum()
                self._active = times[active], faces[active]
                return Witness(start, thrust, minima.lowest), self._ceiling(times, faces, weights), reach
            times, faces = np.append(times, minima.times[low]), np.append(faces, minima.faces[low])
        raise NotSolved("the flight still came closer than the program knew after every round")

    def _ceiling(self, times: Floats, faces: Any, weights: Floats) -> Ceiling | None:
        total = float(weights.sum())
        if total <= 1e-6:
            return None
        kept = weights > 1e-12 * total
        times, faces, weights = times[kept], faces[kept], weights[kept] / total
        weights = weights / weights.sum()
        cuts = self.watch.cuts(times, faces)
        level = bound(cuts.offset, cuts.thrust, weights, self.a_max, 2)
        return Ceiling(weights @ cuts.start[:, :2], level, times, faces, weights)

    def _solve(
        self, offset: Floats, start: Floats, thrust: Floats, direction: Floats | None
    ) -> tuple[Floats, Floats, float, Floats, float]:
        """Start, thrust inside the disk, the common margin asked for or found, the rows' weights, and by the dual how
        far along ``direction`` any start with margin 0 lies (m).
        """
        count = thrust.shape[1] // 2
        free = {"margin": 1} if direction is None else {}
        program = ConeProgram(thrust=2 * count, start=2, **free)
        asked = {"margin": -1.0} if direction is None else {}
        kept = offset if direction is None else offset - CLEARANCE
        program.rows("faces", kept, thrust=self.a_max * thrust, start=start, **asked)
        program.rows("cut", np.array([self.y_max]), start=np.array([[0.0, -1.0]]))
        keep_in_balls(program, count, 2)
        program.minimise(**(asked if direction is None else {"start": -direction}))
        found = program.solve()
        values = [found.value(name) for name in ("thrust", "start", *free)]
        weights = np.maximum(found.weights("faces"), 0.0)
        if not found.solved or not all(np.isfinite(part).all() for part in (*values, weights)):
            raise NotSolved(f"the solver stopped with {found.status}")
        used = self.a_max * into_balls(values[0].reshape(count, 2))
        cut = max(float(found.weights("cut")[0]), 0.0)
        reach = bound(offset, thrust, weights, self.a_max, 2) + cut * self.y_max
        return values[1], used, float(values[2][0]) if free else CLEARANCE, weights, reach

"""The quadratic program of one step of the hopping MPC: paper 004, eq. (29), with its errors corrected.

Unknowns are the impulses at the ends of all hops that remain, the present one first, split by sign for the 1-norm.
States at the ends of hops are affine in them (CWH). Rows of hops are soft: from a dispersed start, and with a barrier,
hard ones have no solution. What differs from the printed program: docs/theory/hopping.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.dynamics.cwh import transition_matrix
from safestart.model.scenario import Floats
from safestart.optim.cone_program import ConeProgram, Each


@dataclass(frozen=True, slots=True)
class Weights:
    """Costs and tolerances of the program.

    ``track`` and ``terminal``: per m^2 off the guidance's distances and the hold point; ``soft``: per m (or per m/s
    over n) that a hop's row is broken; ``position`` (m), ``speed`` (m/s): tolerances of the hops' rows; ``most``: bound
    on each component of an impulse, ``budget``: on their sum, m/s.
    """

    track: float = 1e-2
    terminal: float = 1e-1
    soft: float = 0.05
    position: float = 0.1
    speed: float = 1e-4
    most: float = 20.0
    budget: float = 200.0


@dataclass(frozen=True, slots=True)
class Solved:
    """The impulses (m + 1, 3), m/s LVLH, and whether the solver ended well."""

    impulses: Floats
    solved: bool


class HopProgram:
    """The program for the hops that remain, from one state; it is solved without and with rows on the first impulse."""

    def __init__(
        self,
        mean_motion: float,
        angle_axes: Floats,
        distances: Floats,
        times: Floats,
        state: Floats,
        weights: Weights,
    ) -> None:
        """``angle_axes`` (3, 3): rows along the line, across it in the plane, out of it. ``distances`` (m,) at the ends
        of the hops, ``times`` (m,) of the hops, s."""
        self.n, self.axes, self.weights = mean_motion, angle_axes, weights
        hops = len(times)
        self.hops, self.count = hops, 3 * (hops + 1)
        at_rest = state.copy()
        # reach[j]: state before impulse j from all impulses, (6, 3 (m + 1)).
        reach, free = np.zeros((6, self.count)), at_rest
        self.reach, self.free = [reach], [free]
        for j, time in enumerate(times.tolist()):
            phi = transition_matrix(mean_motion, time)
            reach = reach.copy()
            reach[3:, 3 * j : 3 * j + 3] += np.eye(3)
            reach, free = phi @ reach, phi @ free
            self.reach.append(reach)
            self.free.append(free)
        self._hops(distances)

    def _hops(self, distances: Floats) -> None:
        """Soft rows of the hops, tracking, and the end."""
        w, (along, across, out) = self.weights, self.axes
        flat = abs(along[0]) < 1e-9
        soft, limits, scales = [], [], []
        tracked, targets, costs = [], [], []
        for j in range(1, self.hops + 1):
            reach, free = self.reach[j], self.free[j]
            # (29l), (29m): on the line, and perpendicular to it. (29) does not see the cross-track: on the V-bar its
            # velocity is bounded, elsewhere the position, which a bound on velocity would multiply by 1 / cos phi.
            rows = [(across, 0, w.position, 1.0), (along, 3, w.speed, self.n)]
            rows.append((out, 3, w.speed, self.n) if flat else (out, 0, w.position, 1.0))
            for axis, part, tolerance, scale in rows:
                soft.append(axis @ reach[part : part + 3])
                limits.append((axis @ free[part : part + 3], tolerance))
                scales.append(w.soft / scale)
            tracked.append(along @ reach[:3])
            targets.append(distances[j - 1] - along @ free[:3])
            costs.append(w.terminal if j == self.hops else w.track)
        # The last impulse stops: no velocity is left.
        stop = self.reach[-1][3:].copy()
        stop[:, -3:] += np.eye(3)
        for axis in range(3):
            soft.append(stop[axis])
            limits.append((self.free[-1][3 + axis], w.speed))
            scales.append(w.soft / self.n)
        if flat:
            # (29o) with its sign corrected, for hops to come: no hop is longer than the one before.
            for j in range(1, self.hops):
                before, here, after = (along @ self.reach[k][:3] for k in (j - 1, j, j + 1))
                level = [float(along @ self.free[k][:3]) for k in (j - 1, j, j + 1)]
                soft.append(2.0 * here - before - after)
                limits.append((2.0 * level[1] - level[0] - level[2], np.inf))
                scales.append(w.soft)
        self.soft, self.scales = np.array(soft), np.array(scales)
        self.level = np.array([level for level, _ in limits])
        self.tolerance = np.array([tolerance for _, tolerance in limits])
        self.tracked = np.array(tracked).reshape(-1, self.count)
        self.targets, self.costs = np.array(targets), np.array(costs)

    def solve(
        self, barrier: tuple[Floats, Floats] | None = None, near: tuple[Floats, float] | None = None
    ) -> Solved:
        """Solve. ``barrier``: (G (B, 3), g (B,)), soft rows G u_0 + g >= 0, m; ``near``: u_0 in a box about a point."""
        w, count, barriers = self.weights, self.count, 0 if barrier is None else 1
        sizes = {"plus": count, "minus": count, "soft": len(self.soft), "barrier": barriers}
        program = ConeProgram(**{name: size for name, size in sizes.items() if size})
        # Cost: |u|_1 + soft slack + 1000 barrier slack + tracking.
        gram = (self.tracked * self.costs[:, None]).T @ self.tracked
        pull = self.tracked.T @ (self.costs * self.targets)
        program.minimise(plus=1.0 - 2.0 * pull, minus=1.0 + 2.0 * pull, soft=self.scales)
        program.curve("plus", "plus", 2.0 * gram)
        program.curve("plus", "minus", -2.0 * gram)
        program.curve("minus", "minus", 2.0 * gram)

        def by(rows: Floats) -> dict[str, Floats]:
            """Rows (R, C) over the impulses u = plus - minus."""
            return {"plus": rows, "minus": -rows}

        slack, two_sided = np.eye(len(self.soft)), np.isfinite(self.tolerance)
        edge = np.where(two_sided, self.tolerance, 0.0)
        program.rows("above", edge + self.level, **by(self.soft), soft=slack)
        program.rows(
            "below", (edge - self.level)[two_sided], **by(-self.soft[two_sided]), soft=slack[two_sided]
        )
        if barrier is not None:
            lean, level = barrier
            wide = np.zeros((len(level), count))
            wide[:, :3] = lean
            program.minimise(barrier=100.0 * w.soft)
            program.rows("barrier", level, **by(wide), barrier=1.0)
        if near is not None:
            centre, size = near
            box = np.zeros((6, count))
            box[:3, :3], box[3:, :3] = -np.eye(3), np.eye(3)
            program.rows("near", np.concatenate([size + centre, size - centre]), **by(box))
        for name, size in sizes.items():
            if size:
                program.rows(f"{name} >= 0", np.zeros(size), **{name: Each(np.arange(size)[:, None])})
        for name in ("plus", "minus"):
            most = Each(np.arange(count)[:, None], -1.0)
            program.rows(f"{name} <= most", np.full(count, w.most), **{name: most})
        total = -np.ones((1, count))
        program.rows("budget", np.array([w.budget]), plus=total, minus=total)
        found = program.solve(plain=True)
        impulses = found.value("plus") - found.value("minus")
        return Solved(impulses.reshape(-1, 3), found.solved and bool(np.isfinite(impulses).all()))

"""Tubes of zonotopes: all states of one mode over a time grid and between its nodes.

A set is {c + sum_j xi_j g_j : |xi_j| <= 1}; the xi_j keep their meaning along the tube. Between two nodes a solution
is the linear interpolation of its end points plus an error of at most h^2/8 sup |z''| per component, and z'' = A^2 z
is itself a solution, so sup |z''| <= E_h |A^2 z_k| with E_h an entrywise bound on |e^{As}|, 0 <= s <= h. Treating A^2
z_k as a set keeps the cancellation that a norm of A^2 would lose (mode 2 is stiff). Nonlinear dynamics add a box around
this linear motion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from safestart.model.scenario import Floats
from safestart.passive_safety.model import Motion, matrix
from safestart.passive_safety.reach import chord_error as interpolation
from safestart.passive_safety.reach import tube_kernel
from safestart.passive_safety.reach.flow import flow_table, growth
from safestart.passive_safety.reach.nonlinear import deviation, influence, is_nonlinear
from safestart.passive_safety.reach.rounding import SLACK, UP


@dataclass(frozen=True, slots=True)
class Tube:
    """Nodes t_k = start + k step (min), k = 0..n, of the set of one mode.

    ``centre`` (n+1, 4), ``gens`` (n+1, g, 4); ``noise`` (n+1, 4): round-off at the nodes, and the deviation from the
    linear motion at any time up to them; ``second`` (n, 4): bound on |z''| of the linear motion between nodes.
    """

    motion: Motion
    start: float
    step: float
    centre: Floats
    gens: Floats
    noise: Floats
    second: Floats
    third: Floats

    @property
    def steps(self) -> int:
        """Number of segments n."""
        return len(self.centre) - 1

    @property
    def bend(self) -> Floats:
        """The inflation of the hull of nodes k and k+1, (n, 4)."""
        return interpolation.chord_error(self.step, self.second)

    def until(self, time: float) -> Tube:
        """The tube up to at least ``time`` (min): a view of its first nodes."""
        steps = min(self.steps, max(0, math.ceil((time - self.start) / self.step + 1e-9)))
        nodes = slice(0, steps + 1)
        return replace(
            self,
            centre=self.centre[nodes],
            gens=self.gens[nodes],
            noise=self.noise[nodes],
            second=self.second[:steps],
            third=self.third[:steps],
        )

    def time(self, node: int) -> float:
        """Time of a node, min."""
        return self.start + node * self.step

    def upper(self, rows: Floats) -> Floats:
        """Upper bounds (n, r) of ``rows`` (r, 4) times the state, over each segment; rounded outwards.

        The greater of both nodes plus ``bend``; if ``bend`` is a notable part of the width, a tighter bound on the
        excess: a value that only rises or only falls is greatest at a node; a convex one stays below its chord; and one
        that leaves a node at a rate of at most p and is concave by c at least gains at most p^2 / 2c. Rates and
        curvatures of a row r are rows themselves, r A and r A^2; ``third`` says how far they stray between nodes.
        """
        a = matrix(self.motion)
        once = np.abs(rows) @ np.abs(a)
        bounds: Floats = tube_kernel.upper(
            np.ascontiguousarray(rows),
            np.stack([rows @ a, rows @ a @ a]),
            np.stack([once, once @ np.abs(a)]),
            self.centre,
            self.gens,
            self.noise,
            self.bend,
            self.third,
            self.step,
            _NOTABLE,
            SLACK,
        )
        return bounds

    def node_upper(self, rows: Floats, node: int) -> Floats:
        """Upper bounds (r,) of ``rows`` times the state at one node."""
        size = np.abs(self.centre[node]) + np.abs(self.gens[node]).sum(axis=0)
        noise = (self.noise[node] + SLACK * size) @ np.abs(rows.T)
        result: Floats = rows @ self.centre[node] + np.abs(self.gens[node] @ rows.T).sum(axis=0) + UP * noise
        return result

    def radius(self) -> Floats:
        """Bounds (n,) on the distance from the target over each segment, m."""
        bounds = np.abs(np.stack([self.upper(_PLACES), self.upper(-_PLACES)])).max(axis=0)
        result: Floats = UP * np.hypot(bounds[:, 0], bounds[:, 1])
        return result


_PLACES = np.eye(2, 4)

_NOTABLE = 1e-2
"""Share of the width of a set above which the chord's error gets a tighter bound."""


def propagate(
    motion: Motion,
    centre: Floats,
    gens: Floats,
    start: Fraction,
    step: Fraction,
    steps: int,
    past: float = 0.0,
) -> Tube:
    """Tube of ``centre`` (4,) and ``gens`` (g, 4), given at time 0 of the mode, over ``steps`` steps from ``start``.

    ``past`` (m): distance from the target that is not exceeded before ``start``; nonlinear motion needs it.
    """
    table = flow_table(motion, start, step, steps)
    size = np.abs(centre) + np.abs(gens).sum(axis=0)
    bounds = growth(motion, step)

    def fastest(rate: Floats, terms: Floats) -> Floats:
        """Bound (n, 4) on |``rate`` (n+1, 4, 4) times the state at the start| between the nodes."""
        at = np.abs(rate @ centre) + np.abs(np.matmul(gens, rate.transpose(0, 2, 1))).sum(axis=1)
        between: Floats = UP * ((at + SLACK * (terms @ size))[:-1] @ bounds.T)
        return between

    a = matrix(motion)
    tube = Tube(
        motion,
        float(start),
        float(step),
        table.phi @ centre,
        np.matmul(gens, table.phi.transpose(0, 2, 1)),
        SLACK * (np.abs(table.phi) @ size),
        fastest(table.psi, np.abs(table.psi)),
        fastest(a @ table.psi, np.abs(a) @ np.abs(table.psi)),
    )
    if not is_nonlinear(motion):
        return tube
    # At node k the earlier segments count; at node 0 the start.
    reached = np.concatenate([[max(past, float(np.hypot(*size[:2])))], np.maximum(past, tube.radius())])
    strays = deviation(influence(motion, start, step, steps), reached)
    return replace(tube, noise=UP * (tube.noise + strays))

"""The single-input safety filter (paper 000, eq. 7): one held command, kept inside the rotating corridor's forecast.

Its cost (1 + w_u + w_du) |u - c|^2 + const has the minimiser c = (u_nom + w_du u_prev) / (1 + w_u + w_du), so (7) is
the Euclidean projection of c onto the rows of :class:`safestart.control.forecast.Plan`. When those rows
contradict each other:

1. the speed-limit rows are dropped (a speed limit never outranks the corridor);
2. t* is the least possible value, over the thrust box, of the largest violation of the remaining corridor and keep-out
   rows, in metres of distance from the tightened face (0 when they can all be met);
3. the command is the one nearest to c among those in the box whose largest violation is t*. Without this last part the
   minimiser is often not unique (one face binds, the other axes are free), and a corner of the box would waste thrust
   that the disk then takes from the decisive axis.

The case is reported. Last comes the projection onto the thrust disk (ball in 3-D).
"""

from __future__ import annotations

import math

import numpy as np

from safestart.control import least_violation as _least_violation
from safestart.control.forecast import Plan
from safestart.model.scenario import Floats
from safestart.optim import projection as _projection
from safestart.optim.projection import FEASIBLE
from safestart.runtime.kernels.compiled import compiled

TIE = 1e-8
"""Widening of the fallback's rows (scaled command) so that the set of minimisers keeps an interior."""

_project = _projection.project
_least = _least_violation.least_violation


@compiled(error_model="numpy")
def filter_step(plan, k, x, nominal, previous, command, bounds, work, index):  # type: ignore[no-untyped-def]
    """Solve (7) for control step ``k`` and return whether it was feasible; if not, the command is the fallback's.

    ``x`` (6,) is the LVLH state (m, m/s), ``nominal`` and ``previous`` (d,) are commands in m/s^2. The result goes
    to ``command`` (d,), m/s^2, of length at most a_max. ``bounds`` (rows,), ``work`` (10, 4) and ``index`` (4,)
    integers are scratch.
    """
    normals, weights = plan.normals[k], plan.weights[k]
    rows = plan.state[k]
    d, m = normals.shape
    a_max = plan.law.max_acceleration
    scale = 1.0 / ((1.0 + plan.effort_weight + plan.move_weight) * a_max)
    for i in range(d):
        command[i] = scale * (nominal[i] + plan.move_weight * previous[i])
    for r in range(m):
        bounds[r] = plan.bounds[k, r]
    for c in range(2 * d):
        value = x[plan.components[c]]
        for r in range(m):
            bounds[r] -= rows[c, r] * value
    if plan.keep_out_row >= 0:
        # Copies: the plan may be shared by threads.
        normals, weights = normals.copy(), weights.copy()
        _keep_out(plan, x, normals, bounds, weights)
    worst = -math.inf
    for r in range(m):
        value = -bounds[r]
        for i in range(d):
            value += normals[i, r] * command[i]
        worst = max(worst, value)
    feasible = True
    if worst > _projection.VIOLATION:
        feasible = _project(normals, bounds, command, work, index) == FEASIBLE
    if not feasible:
        for i in range(d):
            command[i] = scale * (nominal[i] + plan.move_weight * previous[i])
        centre = work[9]
        for i in range(d):
            centre[i] = command[i]
        least = _least(normals, bounds, weights, command, work, index)
        # Rows of the fallback, relaxed by the least violation; the rest of the box stays unchanged.
        for r in range(m - 2 * d):
            if weights[r] > 0.0:
                bounds[r] += max(0.0, least) / weights[r] + TIE
            else:
                bounds[r] = math.inf
        # If rounding makes the shrunken set empty, keep the minimax solver's own vertex.
        if _project(normals, bounds, centre, work, index) == FEASIBLE:
            for i in range(d):
                command[i] = centre[i]
    length = 0.0
    for i in range(d):
        length += command[i] * command[i]
    length = a_max / max(math.sqrt(length) / plan.disk_limit, 1.0)
    for i in range(d):
        command[i] *= length
    return feasible


@compiled(error_model="numpy")
def _keep_out(plan, x, normals, bounds, weights):  # type: ignore[no-untyped-def]
    """Write the keep-out row of one step: e . p_1 >= R, linearised at the direction e of the free drift at node 1."""
    d = normals.shape[0]
    row = plan.keep_out_row
    drift = np.empty(3)
    square = 0.0
    for i in range(d):
        drift[i] = 0.0
        for c in plan.components:
            drift[i] += plan.node_transition[i, c] * x[c]
        square += drift[i] * drift[i]
    radius = math.sqrt(square)
    if radius == 0.0:
        # At the target's centre no direction is outward, so the row is empty.
        bounds[row] = math.inf
        return
    length = 0.0
    for c in range(d):
        value = 0.0
        for i in range(d):
            value -= drift[i] * plan.node_input[i, c]
        normals[c, row] = value
        length += value * value
    length = math.sqrt(length)
    for c in range(d):
        normals[c, row] /= length
    weights[row] = plan.law.max_acceleration * length / radius
    bounds[row] = (radius - plan.keep_out_radius) / weights[row]


def filter_command(
    plan: Plan, step: int, state: Floats, nominal: Floats, previous: Floats
) -> tuple[Floats, bool]:
    """Solve (7) once: the command (d,) in m/s^2 and whether (7) was feasible; arguments as for ``filter_step``."""
    command = np.empty(plan.normals.shape[1])
    scratch = np.empty(plan.bounds.shape[1]), np.empty((10, 4)), np.empty(4, np.int64)
    feasible = filter_step(plan, step, state, nominal, previous, command, *scratch)
    return command, bool(feasible)

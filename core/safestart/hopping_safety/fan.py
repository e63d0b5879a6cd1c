"""States with which a chaser may drift on after a hop's impulse: the planned one, some within the errors, the worst."""

from __future__ import annotations

import math

import numpy as np

from safestart.dynamics.burn import frame, misdirected
from safestart.dynamics.cwh import transition_matrix
from safestart.hopping.approach import Approach
from safestart.hopping_safety.quick_proof import position_rows
from safestart.missed_burn.plan import Errors
from safestart.model.scenario import Floats

_SIGNS = ((1, 1, 1, 1), (-1, -1, -1, -1), (1, -1, -1, 1), (-1, 1, 1, -1))
"""Signs of a box's corners: of radial and along-track position and velocity."""
_SHARES = np.linspace(0.0, 1.0, 65)
_PER_ORBIT = 400


def drifts_of(plan: Approach, k: int, errors: Errors) -> Floats:
    """States (5, 6) LVLH after the impulse of hop ``k``: as planned, then corners of the errors in the orbit plane."""
    before, impulse = plan.states()[k], plan.impulses[k]
    found = [_state(before, impulse)]
    for x, y, u, v in _SIGNS:
        box = np.array([x, y, 0, u, v, 0]) * [*errors.position, *errors.velocity]
        burn = _turned(impulse, np.array([-impulse[1], impulse[0], 0.0]), x * errors.thrust_angle)
        found.append(_state(before + box, (1.0 + u * errors.thrust_share) * burn))
    return np.array(found)


def worst_drift(
    plan: Approach, k: int, errors: Errors, horizon: float, when: float, towards: Floats
) -> tuple[Floats, float]:
    """A state (6,) within the errors whose drift over ``horizon`` s comes near the target, and how near, m.

    Of the errors that bring the chaser furthest against ``towards`` at ``when`` s, a share between nothing and all:
    smaller errors are admissible as well, and the whole may carry it past the target.
    """
    before, impulse = plan.states()[k], plan.impulses[k]
    rows = transition_matrix(plan.mean_motion, when)[:3]
    # Where the set holds the target, the nearest member has no direction that means anything.
    sides = (towards, rows @ plan.hops[k].left_with)
    states = np.concatenate([_against(before, impulse, errors, rows.T @ side) for side in sides])
    turns = horizon * plan.mean_motion / math.tau
    times = np.linspace(0.0, horizon, max(math.ceil(_PER_ORBIT * turns), 2))
    nearest = np.linalg.norm(position_rows(plan.mean_motion, times) @ states.T, axis=1).min(axis=0)
    best = int(np.argmin(nearest))
    return states[best], float(nearest[best])


def _against(before: Floats, impulse: Floats, errors: Errors, q: Floats) -> Floats:
    """States (S, 6) with a share of the errors, from none to all, that lower q . state the most; ``q`` (6,)."""
    box = -np.sign(q) * np.array([*errors.position, *errors.velocity])
    size = -math.copysign(errors.thrust_share, float(q[3:] @ impulse))
    return np.array(
        [
            _state(
                before + share * box,
                (1.0 + share * size) * _turned(impulse, -q[3:], share * errors.thrust_angle),
            )
            for share in _SHARES
        ]
    )


def _state(before: Floats, impulse: Floats) -> Floats:
    state = before.copy()
    state[3:] += impulse
    return state


def _turned(impulse: Floats, side: Floats, angle: float) -> Floats:
    """The impulse, turned by ``angle`` (rad) towards ``side`` (3,), or towards any side where that lies along it."""
    along, other, _ = frame(impulse)
    across = side - (side @ along) * along
    size = float(np.linalg.norm(across))
    return misdirected(impulse, angle, across / size if size > 1e-12 * float(np.linalg.norm(side)) else other)

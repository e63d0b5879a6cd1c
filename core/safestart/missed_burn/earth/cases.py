"""Late and lasting burns about the true Earth, as sets of equivalent states at the planned time.

A push e in LVLH at t equals the state f(t) = Phi(0, t) (0, e) at the planned time 0, e turning with LVLH, with the
derivative f' = Phi(0, t) (-e, omega x e), Phi the transition near the reference, which burns as planned. Over a piece
of times f is replaced by its tangent in the middle and a box for the change of f'; the integral of f over a piece is
its length times f in the middle and half that box.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.dynamics.burn import frame
from safestart.dynamics.two_body_kernel import frame_of
from safestart.missed_burn.earth.motion import Drift, drift_after, inverse, moved
from safestart.missed_burn.plan import Question, duration_of
from safestart.missed_burn.sets import Case, StateSet, pieces, shell
from safestart.model.scenario import Floats

_LOOSE = 12.0
"""The box for the change of f' over a piece: this times the turn of LVLH over half of it, for |e| = 1. The checker
encloses the same change by ball arithmetic, which needs a part of it."""


def late_and_stuck(question: Question, k: int, before: StateSet, after: StateSet) -> list[Case]:
    """Cases of burn ``k``; ``before`` and ``after`` it are inertial sets."""
    if not (question.failures.late or question.failures.stuck):
        return []
    drift = drift_after(question, k, 1.0)
    burn, failures, errors = question.plan.burns[k], question.failures, question.errors
    along, one, two = frame(np.array(burn.impulse))
    middle, half, across = shell(1.0 - errors.thrust_share, 1.0 + errors.thrust_share, errors.thrust_angle)
    loose = math.hypot(half, across)
    time, rate = burn.time, math.sqrt(drift.stiffness)
    out: list[Case] = []
    for first, last in pieces(failures.late, 2.0 * rate * burn.size):
        at, reach = 0.5 * (first + last), 0.5 * (last - first)
        lifted, change = _pushes(drift, at)
        late = before.copy()
        late.centre = late.centre + burn.size * middle * (lifted @ along)
        late.block([burn.size * half * (lifted @ along)], "along", k)
        late.block([burn.size * across * (lifted @ u) for u in (one, two)], "across", k)
        late.block([reach * burn.size * middle * (change @ along)], "piece", k)
        size = _size(rate, last)
        late.box(burn.size * reach * (_bend(rate, reach, last) + loose * size), "bend")
        out.append(late.case("late", k, time, duration_of(question, "late", k, last), (first, last)))
    reached, done = np.zeros(6), 0.0
    push = middle * failures.acceleration
    for first, last in pieces(failures.stuck, failures.acceleration):
        at, reach = 0.5 * (first + last), 0.5 * (last - first)
        # Up to the middle of this piece: the rest of the last one, and half of this one.
        reached = reached + (at - done) * (_pushes(drift, 0.5 * (at + done))[0] @ along)
        spread: Floats = at * reach * _bend(rate, reach, last)
        done = at
        stuck = after.copy()
        stuck.centre = stuck.centre + push * reached
        stuck.block([reach * push * (_pushes(drift, at)[0] @ along)], "piece", k)
        stuck.box(failures.acceleration * (spread + 0.5 * reach * reach * _size(rate, last)), "bend")
        stuck.box(loose * failures.acceleration * _kicked(rate, last), "loose")
        out.append(stuck.case("stuck", k, time, duration_of(question, "stuck", k, last), (first, last)))
    return out


def _pushes(drift: Drift, seconds: float) -> tuple[Floats, Floats]:
    """f and f' (6, 3) per unit of e in LVLH."""
    target, _ = moved(drift.target, seconds)
    _, phi = moved(drift.chaser, seconds)
    rows, omega = np.empty((3, 3)), np.empty(3)
    frame_of(target, rows, omega)
    turn = np.array([[0.0, -omega[2], 0.0], [omega[2], 0.0, -omega[0]], [0.0, omega[0], 0.0]])
    back = inverse(phi)
    return back[:, 3:] @ rows.T, back[:, :3] @ -rows.T + back[:, 3:] @ (rows.T @ turn)


def _size(rate: float, longest: float) -> Floats:
    """Bound (6,) on |f'| for |e| = 1, up to ``longest`` s: the transition's blocks grow like cosh and sinh, and LVLH
    does not turn faster than ``rate``."""
    return np.repeat([1.25, 2.0 * rate], 3) * max(math.exp(rate * longest), 2.0)


def _bend(rate: float, reach: float, longest: float) -> Floats:
    """Bound (6,) on the change of f' over ``reach`` s, |e| = 1."""
    return _LOOSE * rate * reach * np.repeat([1.0, rate], 3) * max(0.5 * math.exp(rate * longest), 1.0)


def _kicked(rate: float, seconds: float) -> Floats:
    """(6,): what a push of 1 m/s^2 in any direction does in a time."""
    p = rate * seconds
    return np.repeat([(math.cosh(p) - 1.0) / rate**2, math.sinh(p) / rate], 3)

"""The ancillary feedback of the tube: how far a unit disturbance drives the chaser off its plan, at all times.

CWH splits into the orbit plane and the cross-track axis. In each, u = v + K e with e = x - z, K the discrete LQR of
the held input; e+ = (A + B K) e + w_d, and between the nodes e(s) = (Phi(s) + B(s) K) e_k + the effect of w since t_k.
All bounds are linear in the disturbance and hold in every direction of the plane, however the corridor turns.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.model.scenario import Floats
from safestart.sets.invariant import Invariant, Push

LONGEST_INTERVAL = 60.0
"""Longest hold of thrust (s): the bounds below need n dt well under 1."""
_DIRECTIONS = 96
_PANELS = 8
_LONGEST_SAMPLE, _FEWEST_SAMPLES, _MOST_SAMPLES = 0.25, 4, 64
_AXES = {"plane": (0, 1), "cross": (2,)}


@dataclass(frozen=True, slots=True)
class Reach:
    """Bounds per unit of (disturbance m/s^2, start position error m, start velocity error m/s), arrays (3,).

    ``position`` on |r error| in metres at all times, ``thrust`` on |K e| in m/s^2; ``gain`` (d, 2 d) is K.
    ``epsilon`` as in :class:`~safestart.sets.invariant.Invariant`.
    """

    gain: Floats
    position: Floats
    thrust: Floats
    epsilon: float


@lru_cache(maxsize=32)
def reach_of(mean_motion: float, dt: float, settle: float, part: str) -> Reach | None:
    """Bounds for ``part`` "plane" or "cross"; None when the feedback does not contract."""
    phi, held = _motion(mean_motion, dt, part)
    d = held.shape[1]
    gain = _regulator(phi, held, settle)
    if gain is None:
        return None
    invariant = Invariant.of(phi + held @ gain, _push(mean_motion, dt, part))
    if invariant is None:
        return None
    unit, widen = _circle(d)
    sources = (slice(0, d), slice(d, 2 * d))

    def worst(directions: Floats) -> Floats:
        found = [invariant.support(directions), *(invariant.transient(directions, s) for s in sources)]
        return widen * np.array([row.max() for row in found])

    thrust = worst(unit @ gain)
    speed = worst(np.hstack([np.zeros_like(unit), unit]))
    samples = min(max(_FEWEST_SAMPLES, math.ceil(dt / _LONGEST_SAMPLE)), _MOST_SAMPLES)
    position = np.zeros(3)
    for k in range(samples + 1):
        free, push = _motion(mean_motion, dt * k / samples, part)
        along = unit @ (free + push @ gain)[:d]
        here = worst(along)
        late = _push(mean_motion, dt * k / samples, part).support(np.hstack([unit, np.zeros_like(unit)]))
        here[0] += widen * late.max()
        position = np.maximum(position, here)
    return Reach(
        gain,
        position + _between(mean_motion, dt, dt / samples, position, speed, thrust),
        thrust,
        invariant.epsilon,
    )


def _regulator(phi: Floats, held: Floats, settle: float) -> Floats | None:
    """Discrete LQR gain (d, 2 d) of position against thrust: a double integrator settles with the time constant (s).

    Weights 1 and settle^4: in positions of settle^2 and velocities of settle both are 1, which conditions the equation.
    """
    from scipy.linalg import solve_discrete_are

    d = held.shape[1]
    scale = np.array([settle**2] * d + [settle] * d)
    a, b = phi * scale / scale[:, None], held / scale[:, None]
    try:
        riccati = solve_discrete_are(a, b, np.diag([1.0] * d + [0.0] * d), np.eye(d))
    except (np.linalg.LinAlgError, ValueError):
        return None
    found = np.linalg.solve(np.eye(d) + b.T @ riccati @ b, b.T @ riccati @ a)
    return np.asarray(-found / scale, dtype=np.float64)


def _between(n: float, dt: float, h: float, position: Floats, speed: Floats, thrust: Floats) -> Floats:
    """Largest growth of the distance between samples h apart: h^2 / 8 times the error's largest acceleration.

    |r''| <= 3 n^2 |r| + 2 n |v| + |K e| + |w|; the Coriolis term does no work, so |v| grows by the rest times dt.
    """
    push = thrust + np.array([1.0, 0.0, 0.0])
    gravity, bend = 3.0 * n * n, h * h / 8.0
    fastest = speed + dt * (gravity * position + push)
    acceleration = gravity * position + 2.0 * n * fastest + push
    out: Floats = bend * acceleration / (1.0 - gravity * bend * (1.0 + 2.0 * n * dt))
    return out


def _circle(d: int) -> tuple[Floats, float]:
    """Unit directions of half a turn, and the factor by which a direction between two may exceed both.

    Between directions 2 b apart any unit vector is their combination with non-negative weights of sum <= 1 / cos b.
    """
    if d == 1:
        return np.ones((1, 1)), 1.0
    angle = np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    return np.column_stack([np.cos(angle), np.sin(angle)]), 1.0 / math.cos(0.5 * math.pi / _DIRECTIONS)


def _motion(mean_motion: float, tau: float, part: str) -> tuple[Floats, Floats]:
    axes = list(_AXES[part])
    keep = axes + [3 + k for k in axes]
    return transition_matrix(mean_motion, tau)[np.ix_(keep, keep)], input_matrix(mean_motion, tau)[
        np.ix_(keep, axes)
    ]


def _push(n: float, h: float, part: str) -> Push:
    """Effect on the state of a disturbance |w(s)| <= 1 m/s^2, any measurable history of h seconds."""
    d = len(_AXES[part])
    columns = np.array([_motion(n, h * k / _PANELS, part)[0][:, d:] for k in range(_PANELS + 1)])
    # After a unit kick |v| <= V and |r| <= h V: the Coriolis term does no work, the gravity gradient is 3 n^2 |r|.
    fastest = 1.0 / (1.0 - 1.5 * n * n * h * h)
    bend = 3.0 * n * n * h * fastest + 2.0 * n * fastest
    jerk = 3.0 * n * n * fastest + 2.0 * n * bend
    missed = h * (h / _PANELS) ** 2 / 12.0
    return Push(columns, h / _PANELS, missed * np.array([bend] * d + [jerk] * d))

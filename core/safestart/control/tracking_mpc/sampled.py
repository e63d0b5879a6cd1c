"""HCW sampled with one input per step, and the two tail controllers in LVLH (paper 002, section IV-A).

x(k+1) = A x(k) + B u(k), u in m/s: an impulse at the end of the step (B = [0; I]), or thrust u / T held over it. Every
trajectory is made of a free sequence s(k) in space, the flat output of the pair (A, B):

    x(k) = X0 s(k) + X1 s(k+1),    u(k) = P s(k+2) + Q s(k+1) + R s(k).

With impulses s is the position: P = A_rv^-1. With held thrust the position is about the mean of s(k) and s(k+1).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import solve_discrete_are

from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.errors import invalid
from safestart.model.scenario import Floats

LARGEST_PHASE = 0.5
"""Largest turn of the orbit in two steps, rad; beyond it A_rv is nearly singular and the bounds on theta are
useless."""


_POINTS = 5
"""Nodes from which held thrust takes s: exact for motions that are polynomials in time of one degree less."""


@dataclass(frozen=True)
class Sampled:
    """``mean_motion`` rad/s and ``period`` T in s; raises ``InvalidInput`` where 2 n T is not in (0, 0.5] or T not > 0.

    ``a`` (6, 6), ``b`` (6, 3). ``p``, ``q``, ``r`` (3, 3) are P, Q, R; ``flat`` (2, 6, 3) is X0, X1. ``weights`` (m,):
    s(k) of a point that moves through r(k) is the sum of weights[i] r(k+i).
    """

    mean_motion: float
    period: float
    held: bool = False
    a: Floats = field(init=False, repr=False, compare=False)
    b: Floats = field(init=False, repr=False, compare=False)
    p: Floats = field(init=False, repr=False, compare=False)
    q: Floats = field(init=False, repr=False, compare=False)
    r: Floats = field(init=False, repr=False, compare=False)
    flat: Floats = field(init=False, repr=False, compare=False)
    weights: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if not (math.isfinite(self.period) and self.period > 0.0):
            raise invalid("period", "a finite time > 0 s", self.period)
        if 2.0 * self.mean_motion * self.period > LARGEST_PHASE:
            longest = LARGEST_PHASE / 2.0 / self.mean_motion
            required = f"a period T with 2 n T <= {LARGEST_PHASE:g} rad, T <= {longest:g} s"
            raise invalid("period", required, self.period)
        a = transition_matrix(self.mean_motion, self.period)
        p = np.eye(3) / self.period
        if self.held:
            b = input_matrix(self.mean_motion, self.period) / self.period
            ends = np.linalg.solve(np.hstack([b, a @ b]), -a @ (a @ b @ p))
            r, q = ends[:3], ends[3:]
            flat = np.array([a @ b @ p + b @ q, b @ p])
            # A constant s is a constant position.
            scale = np.linalg.inv(flat[0, :3] + flat[1, :3])
            p, q, r, flat = p @ scale, q @ scale, r @ scale, flat @ scale
            weights = _smooth_weights(_POINTS)
        else:
            p[:] = np.linalg.inv(a[:3, 3:])
            q, r = -p @ a[:3, :3] - a[3:, 3:] @ p, a[3:, 3:] @ p @ a[:3, :3] - a[3:, :3]
            b = np.vstack([np.zeros((3, 3)), np.eye(3)])
            flat = np.array([np.vstack([np.eye(3), -p @ a[:3, :3]]), np.vstack([np.zeros((3, 3)), p])])
            weights = np.ones(1)
        made = {"a": a, "b": b, "p": p, "q": q, "r": r, "flat": flat, "weights": weights}
        for name, value in made.items():
            object.__setattr__(self, name, np.ascontiguousarray(value, dtype=np.float64))

    @property
    def reached_from(self) -> int:
        """The first node whose position an input of step 0 changes."""
        return 1 if self.held else 2

    @property
    def ahead(self) -> int:
        """Attitudes that one equilibrium input needs, its own step's first."""
        return len(self.weights) + 2

    def after(self, state: Floats, given: Floats) -> Floats:
        """The state (6,) one step later with the LVLH input ``given`` (3,), m/s."""
        out: Floats = self.a @ state + self.b @ given
        return out

    def dead_beat(self) -> Floats:
        """Gain (3, 6): two inputs K e bring any deviation e to 0."""
        if self.held:
            # The first of the only two inputs that do; in the next step the same formula gives the second.
            both = np.linalg.solve(np.hstack([self.a @ self.b, self.b]), -self.a @ self.a)
            return np.ascontiguousarray(both[:3])
        rr, rv, vr, vv = self.a[:3, :3], self.a[:3, 3:], self.a[3:, :3], self.a[3:, 3:]
        return np.hstack([-self.p @ (rr @ rr + rv @ vr), -self.p @ (rr @ rv + rv @ vv)])

    def regulator(self, weight: float) -> Floats:
        """Gain (3, 6) of the infinite-horizon LQR with |e|^2 + weight |w|^2; refuses a weight <= 0."""
        if not (math.isfinite(weight) and weight > 0.0):
            raise invalid("rho", "a finite number > 0", weight)
        b = self.b
        cost = solve_discrete_are(self.a, b, np.eye(6), weight * np.eye(3))
        gain = np.linalg.solve(weight * np.eye(3) + b.T @ cost @ b, b.T @ cost @ self.a)
        return np.asarray(-gain, dtype=np.float64)


def _smooth_weights(count: int) -> Floats:
    """Weights (count,) of s = sum of weights[i] r(i): half the sum of s at neighbouring steps is r, for polynomials.

    s(t) = sech(D / 2) r at t - 1/2 with D the derivative in steps; sech(x) = 1 - x^2 / 2 + 5 x^4 / 24 - ..
    """
    nodes, at = np.arange(float(count)), -0.5
    series = (1.0, 0.0, -0.125, 0.0, 5.0 / 384.0)
    wanted = []
    for power in range(count):
        value = 0.0
        for order in range(min(power, 4) + 1):
            value += series[order] * math.perm(power, order) * at ** (power - order)
        wanted.append(value)
    out: Floats = np.linalg.solve(np.vander(nodes, count, increasing=True).T, np.array(wanted))
    return out

"""HCW sampled with an impulse at the end of every step, and the two tail controllers in LVLH (paper 002, section IV-A).

x(k+1) = A x(k) + [0; I] u(k). The dead-beat gain is the paper's (30)-(31) with the A_rv^-1 that (31) lacks.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import solve_discrete_are

from safestart.dynamics.cwh import transition_matrix
from safestart.errors import invalid
from safestart.model.scenario import Floats

LARGEST_PHASE = 0.5
"""Largest turn of the orbit in two steps, rad; beyond it A_rv is nearly singular and the bounds on theta are
useless."""


@dataclass(frozen=True)
class Sampled:
    """``mean_motion`` rad/s and ``period`` T in s; raises ``InvalidInput`` where 2 n T is not in (0, 0.5] or T not > 0.

    ``a`` (6, 6); P = A_rv^-1, Q = -P A_rr - A_vv P and R = A_vv P A_rr - A_vr, (3, 3) each, give the input of an
    equilibrium from its three next positions: u_e(k) = P r(k+2) + Q r(k+1) + R r(k).
    """

    mean_motion: float
    period: float
    a: Floats = field(init=False, repr=False, compare=False)
    p: Floats = field(init=False, repr=False, compare=False)
    q: Floats = field(init=False, repr=False, compare=False)
    r: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if not (math.isfinite(self.period) and self.period > 0.0):
            raise invalid("period", "a finite time > 0 s", self.period)
        if 2.0 * self.mean_motion * self.period > LARGEST_PHASE:
            longest = LARGEST_PHASE / 2.0 / self.mean_motion
            required = f"a period T with 2 n T <= {LARGEST_PHASE:g} rad, T <= {longest:g} s"
            raise invalid("period", required, self.period)
        a = transition_matrix(self.mean_motion, self.period)
        p = np.linalg.inv(a[:3, 3:])
        object.__setattr__(self, "a", a)
        object.__setattr__(self, "p", p)
        object.__setattr__(self, "q", -p @ a[:3, :3] - a[3:, 3:] @ p)
        object.__setattr__(self, "r", a[3:, 3:] @ p @ a[:3, :3] - a[3:, :3])

    def dead_beat(self) -> Floats:
        """Gain (3, 6): two inputs K e bring any deviation e to 0."""
        rr, rv, vr, vv = self.a[:3, :3], self.a[:3, 3:], self.a[3:, :3], self.a[3:, 3:]
        return np.hstack([-self.p @ (rr @ rr + rv @ vr), -self.p @ (rr @ rv + rv @ vv)])

    def regulator(self, weight: float) -> Floats:
        """Gain (3, 6) of the infinite-horizon LQR with |e|^2 + weight |w|^2; refuses a weight <= 0."""
        if not (math.isfinite(weight) and weight > 0.0):
            raise invalid("rho", "a finite number > 0", weight)
        b = np.vstack([np.zeros((3, 3)), np.eye(3)])
        cost = solve_discrete_are(self.a, b, np.eye(6), weight * np.eye(3))
        gain = np.linalg.solve(weight * np.eye(3) + b.T @ cost @ b, b.T @ cost @ self.a)
        return np.asarray(-gain, dtype=np.float64)

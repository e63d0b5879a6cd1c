"""Motions that are not steady or not planar, and flights integrated step by step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from safestart.dynamics.cwh import Cwh, input_matrix, system_matrix, transition_matrix
from safestart.dynamics.motion import RelativeMotion
from safestart.model.scenario import Floats


@dataclass(frozen=True)
class TwoOrbits(RelativeMotion):
    """CWH with one mean motion before ``switch`` (s) and another after it: linear, and not the same at all times."""

    before: float = 1.1e-3
    after: float = 9e-3
    switch: float = 33.5

    def transition(self, t0: float, t1: float) -> Floats:
        meet = min(max(self.switch, t0), t1)
        return transition_matrix(self.after, t1 - meet) @ transition_matrix(self.before, meet - t0)

    def held(self, t0: float, t1: float) -> Floats:
        meet = min(max(self.switch, t0), t1)
        carried = transition_matrix(self.after, t1 - meet) @ input_matrix(self.before, meet - t0)
        return carried + input_matrix(self.after, t1 - meet)

    def matrix(self, time: float) -> Floats:
        """A at one time, (6, 6)."""
        return system_matrix(self.before if time < self.switch else self.after)


@dataclass(frozen=True)
class Tilted(RelativeMotion):
    """:class:`TwoOrbits` in axes turned by ``angle`` (rad) about x: the plane z = 0 does not keep to itself."""

    angle: float = 0.4

    @property
    def turn(self) -> Floats:
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])

    def transition(self, t0: float, t1: float) -> Floats:
        both = np.kron(np.eye(2), self.turn)
        return both @ TwoOrbits().transition(t0, t1) @ both.T

    def held(self, t0: float, t1: float) -> Floats:
        return np.kron(np.eye(2), self.turn) @ TwoOrbits().held(t0, t1) @ self.turn.T

    def matrix(self, time: float) -> Floats:
        both = np.kron(np.eye(2), self.turn)
        return both @ TwoOrbits().matrix(time) @ both.T


def matrix_of(motion: RelativeMotion, time: float) -> Floats:
    """A of x' = A x + [0; u], (6, 6)."""
    if isinstance(motion, Cwh):
        return system_matrix(motion.mean_motion)
    assert isinstance(motion, TwoOrbits | Tilted)
    return motion.matrix(time)


def integrate(
    motion: RelativeMotion, dt: float, begin: float, state: Floats, thrust: Floats, times: Floats
) -> Floats:
    """States (J, 2 d) at ``times`` (J,) after ``begin``, ``thrust`` (N, d) held over intervals: x' = A x + [0; u]."""
    d = thrust.shape[1]
    keep = np.r_[0:d, 3 : 3 + d]
    out = []
    for time in times.tolist():
        x = np.zeros(6)
        x[keep] = state
        now = begin
        for k, push in enumerate(thrust):
            end = begin + min((k + 1) * dt, time)
            # Cut where A jumps, so that the integrator sees a smooth right side.
            for cut in (TwoOrbits().switch, end):
                stop = min(cut, end)
                if stop > now:
                    x = _carried(matrix_of(motion, 0.5 * (now + stop)), push, stop - now, x)
                    now = stop
        out.append(x[keep])
    return np.array(out)


def _carried(a: Floats, push: Floats, duration: float, x: Floats) -> Floats:
    u = np.zeros(6)
    u[3 : 3 + len(push)] = push
    done = solve_ivp(lambda _, y: a @ y + u, (0.0, duration), x, "DOP853", rtol=1e-12, atol=1e-12)
    out: Floats = done.y[:, -1]
    return out

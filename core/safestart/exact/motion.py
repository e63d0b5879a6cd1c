"""CWH motion at many times at once, for thrust held over equal intervals: the tables behind the exact answer."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.model.scenario import Floats


@dataclass(frozen=True, slots=True)
class NodeTables:
    """States at the N nodes t_k = k dt, k < N, and within an interval; the state is (position, velocity), (2 d,).

    ``free`` (N, 2 d, 2 d) and ``driven`` (N, 2 d, N d): x(t_k) = free_k x0 + driven_k u. ``along`` (2 d, (S+1) 2 d) and
    ``held`` (d, (S+1) 2 d): states at S+1 equally spaced times of an interval from its first state and its thrust.
    """

    free: Floats
    driven: Floats
    along: Floats
    held: Floats

    def until(self, steps: int) -> NodeTables:
        """The tables of the first ``steps`` intervals: views."""
        push = self.held.shape[0]
        return replace(self, free=self.free[:steps], driven=self.driven[:steps, :, : steps * push])

    def flight(self, state: Floats, thrust: Floats) -> Floats:
        """States (N, S+1, 2 d) of the flight from ``state`` (2 d,) under ``thrust`` (N, d), both ends included."""
        count, size, _ = self.free.shape
        nodes = (self.free @ state) + (self.driven.reshape(count * size, -1) @ thrust.ravel()).reshape(
            count, -1
        )
        out: Floats = (nodes @ self.along + thrust @ self.held).reshape(count, -1, size)
        return out


def motion_tables(mean_motion: float, dt: float, steps: int, dimensions: int, samples: int) -> NodeTables:
    """Tables for N = ``steps`` intervals of ``dt`` seconds with ``samples`` parts each."""
    # Kept apart: the tumble rate decides the samples, and the large tables do not depend on them.
    nodes = _nodes(mean_motion, dt, steps, dimensions)
    return NodeTables(*nodes, *_within(mean_motion, dt, dimensions, samples))


@lru_cache(maxsize=4)
def _nodes(mean_motion: float, dt: float, steps: int, d: int) -> tuple[Floats, Floats]:
    step, push = moved(mean_motion, dt, d)
    free = np.empty((steps, 2 * d, 2 * d))
    driven = np.zeros((steps, 2 * d, steps * d))
    free[0] = np.eye(2 * d)
    for k in range(1, steps):
        free[k] = moved(mean_motion, k * dt, d)[0]
        driven[k] = step @ driven[k - 1]
        driven[k, :, (k - 1) * d : k * d] = push
    return free, driven


@lru_cache(maxsize=64)
def _within(mean_motion: float, dt: float, d: int, samples: int) -> tuple[Floats, Floats]:
    parts = [moved(mean_motion, dt * s / samples, d) for s in range(samples + 1)]
    along = np.hstack([phi.T for phi, _ in parts])
    held = np.hstack([push.T for _, push in parts])
    return np.ascontiguousarray(along), np.ascontiguousarray(held)


def moved(mean_motion: float, tau: float, d: int) -> tuple[Floats, Floats]:
    """Phi(tau) (2 d, 2 d) and B_d(tau) (2 d, d) for one time in seconds."""
    keep = np.r_[0:d, 3 : 3 + d]
    return transition_matrix(mean_motion, tau)[np.ix_(keep, keep)], input_matrix(mean_motion, tau)[keep, :d]


def _phases(phase: Floats) -> tuple[Floats, Floats, Floats]:
    """sin(p)/p, (1 - cos p)/p^2 and (p - sin p)/p^3, by series: exact at 0, to 1e-16 for |p| <= 0.5."""
    square = phase * phase
    # The first term left out is below p^8 / 9! < 3e-18 for p^2 < 1e-3, below p^14 / 15! < 5e-17 for |p| <= 0.5.
    terms = 3 if not len(phase) or float(square.max()) < 1e-3 else 6
    sinc = versine = cubic = np.ones_like(square)
    for k in range(terms - 1, -1, -1):
        sinc = 1.0 - square / ((2 * k + 2) * (2 * k + 3)) * sinc
        versine = 1.0 - square / ((2 * k + 3) * (2 * k + 4)) * versine
        cubic = 1.0 - square / ((2 * k + 4) * (2 * k + 5)) * cubic
    return sinc, versine / 2.0, cubic / 6.0


def held_displacement(mean_motion: float, tau: Floats, dimensions: int) -> tuple[Floats, Floats]:
    """Position rows of Phi(tau), (J, d, 2 d), and of B_d(tau), (J, d, d), for J times in seconds."""
    d, count = dimensions, len(tau)
    p = mean_motion * tau
    if count and float(np.abs(p).max()) > 0.5:
        parts = [moved(mean_motion, float(t), d) for t in tau]
        return np.array([phi[:d] for phi, _ in parts]), np.array([push[:d] for _, push in parts])
    f1, f2, f3 = _phases(p)
    square = tau * tau
    free, held = np.zeros((count, d, 2 * d)), np.zeros((count, d, d))
    swing = 2.0 * tau * p * f2
    free[:, 0, 0] = 1.0 + 3.0 * p * p * f2
    free[:, 1, 0] = -6.0 * p**3 * f3
    free[:, 1, 1] = 1.0
    free[:, 0, d], free[:, 0, d + 1] = tau * f1, swing
    free[:, 1, d], free[:, 1, d + 1] = -swing, tau * (4.0 * f1 - 3.0)
    sweep = 2.0 * square * p * f3
    held[:, 0, 0], held[:, 0, 1] = square * f2, sweep
    held[:, 1, 0], held[:, 1, 1] = -sweep, square * (4.0 * f2 - 1.5)
    if d == 3:
        free[:, 2, 2], free[:, 2, 5] = 1.0 - p * p * f2, tau * f1
        held[:, 2, 2] = square * f2
    return free, held

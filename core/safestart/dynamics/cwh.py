"""Clohessy-Wiltshire-Hill relative motion in closed form (paper 000, eqs. 1-2).

Every entry is tau^k times a smooth function of the phase n tau, so nothing is lost to cancellation as
n tau -> 0 and n = 0 (the double integrator) is exact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.dynamics.motion import SteadyMotion
from safestart.errors import invalid
from safestart.model.scenario import MAX_MEAN_MOTION, Floats, Target, number


def phase_functions(phase: float) -> tuple[float, float, float]:
    """sin(p)/p, (1 - cos p)/p^2 and (p - sin p)/p^3, by series where the direct form cancels."""
    if abs(phase) < 0.5:
        square = phase * phase
        sinc = versine = cubic = 0.0
        term = 1.0
        for k in range(11):
            # term = (-1)^k p^(2k) / (2k)!
            sinc += term / (2 * k + 1)
            versine += term / ((2 * k + 1) * (2 * k + 2))
            cubic += term / ((2 * k + 1) * (2 * k + 2) * (2 * k + 3))
            term *= -square / ((2 * k + 1) * (2 * k + 2))
        return sinc, versine, cubic
    sine = math.sin(phase)
    half = math.sin(0.5 * phase)
    return sine / phase, 2.0 * half * half / phase**2, (phase - sine) / phase**3


def _check(mean_motion: float, tau: float) -> None:
    if not (math.isfinite(mean_motion) and mean_motion >= 0.0):
        raise invalid("mean_motion", "a finite number >= 0 rad/s", mean_motion)
    if not math.isfinite(tau):
        raise invalid("tau", "a finite time in seconds", tau)


def system_matrix(mean_motion: float) -> Floats:
    """Continuous-time A, shape (6, 6), of eq. (1); the input matrix is [0; I]."""
    _check(mean_motion, 0.0)
    n = mean_motion
    a = np.zeros((6, 6))
    a[:3, 3:] = np.eye(3)
    a[3, 0], a[3, 4], a[4, 3], a[5, 2] = 3.0 * n * n, 2.0 * n, -2.0 * n, -n * n
    return a


def transition_matrix(mean_motion: float, tau: float) -> Floats:
    """State-transition matrix Phi(tau), shape (6, 6), state (x, y, z, vx, vy, vz) (eq. 2).

    ``tau`` in seconds may be negative; ``mean_motion`` in rad/s may be 0.
    """
    _check(mean_motion, tau)
    n = mean_motion
    p = n * tau
    f1, f2, f3 = phase_functions(p)
    c = math.cos(p)
    phi = np.zeros((6, 6))
    phi[0] = [1.0 + 3.0 * p * p * f2, 0.0, 0.0, tau * f1, 2.0 * tau * p * f2, 0.0]
    phi[1] = [-6.0 * p**3 * f3, 1.0, 0.0, -2.0 * tau * p * f2, tau * (4.0 * f1 - 3.0), 0.0]
    phi[2] = [0.0, 0.0, c, 0.0, 0.0, tau * f1]
    phi[3] = [3.0 * n * p * f1, 0.0, 0.0, c, 2.0 * p * f1, 0.0]
    phi[4] = [-6.0 * n * p * p * f2, 0.0, 0.0, -2.0 * p * f1, 4.0 * c - 3.0, 0.0]
    phi[5] = [0.0, 0.0, -n * p * f1, 0.0, 0.0, c]
    return phi


def input_matrix(mean_motion: float, tau: float) -> Floats:
    """Zero-order-hold input matrix B_d(tau), shape (6, 3): the integral of Phi(s) [0; I] over [0, tau]."""
    _check(mean_motion, tau)
    p = mean_motion * tau
    f1, f2, f3 = phase_functions(p)
    square = tau * tau
    bd = np.zeros((6, 3))
    bd[0, :2] = [square * f2, 2.0 * square * p * f3]
    bd[1, :2] = [-2.0 * square * p * f3, square * (4.0 * f2 - 1.5)]
    bd[2, 2] = square * f2
    bd[3, :2] = [tau * f1, 2.0 * tau * p * f2]
    bd[4, :2] = [-2.0 * tau * p * f2, tau * (4.0 * f1 - 3.0)]
    bd[5, 2] = tau * f1
    return bd


def moves_of(mean_motion: float, tau: Floats) -> tuple[Floats, Floats]:
    """:func:`transition_matrix` (J, 6, 6) and :func:`input_matrix` (J, 6, 3) at J times, s, with the same bits."""
    _check(mean_motion, float(np.abs(tau).max(initial=0.0)))
    n, p = mean_motion, mean_motion * tau
    f1, f2, f3 = _phases_alike(p)
    # Python's cosine and power: NumPy's may round differently.
    c = np.array([math.cos(one) for one in p.tolist()])
    cube = np.array([one**3 for one in p.tolist()])
    phi, bd = np.zeros((len(tau), 6, 6)), np.zeros((len(tau), 6, 3))
    along, swing = tau * f1, 2.0 * tau * p * f2
    phi[:, 0, 0], phi[:, 0, 3], phi[:, 0, 4] = 1.0 + 3.0 * p * p * f2, along, swing
    phi[:, 1, 0], phi[:, 1, 1], phi[:, 1, 3] = -6.0 * cube * f3, 1.0, -2.0 * tau * p * f2
    phi[:, 1, 4] = tau * (4.0 * f1 - 3.0)
    phi[:, 2, 2], phi[:, 2, 5] = c, along
    phi[:, 3, 0], phi[:, 3, 3], phi[:, 3, 4] = 3.0 * n * p * f1, c, 2.0 * p * f1
    phi[:, 4, 0], phi[:, 4, 3], phi[:, 4, 4] = -6.0 * n * p * p * f2, -2.0 * p * f1, 4.0 * c - 3.0
    phi[:, 5, 2], phi[:, 5, 5] = -n * p * f1, c
    square = tau * tau
    bd[:, 0, 0], bd[:, 0, 1] = square * f2, 2.0 * square * p * f3
    bd[:, 1, 0], bd[:, 1, 1] = -2.0 * square * p * f3, square * (4.0 * f2 - 1.5)
    bd[:, 2, 2] = square * f2
    bd[:, 3, 0], bd[:, 3, 1] = along, swing
    bd[:, 4, 0], bd[:, 4, 1] = -2.0 * tau * p * f2, tau * (4.0 * f1 - 3.0)
    bd[:, 5, 2] = along
    return phi, bd


def _phases_alike(phase: Floats) -> tuple[Floats, Floats, Floats]:
    """:func:`phase_functions` of many phases, with the same bits."""
    square = phase * phase
    (sinc, versine, cubic), term = np.zeros((3, len(phase))), np.ones(len(phase))
    for k in range(11):
        sinc += term / (2 * k + 1)
        versine += term / ((2 * k + 1) * (2 * k + 2))
        cubic += term / ((2 * k + 1) * (2 * k + 2) * (2 * k + 3))
        term *= -square / ((2 * k + 1) * (2 * k + 2))
    for j in np.nonzero(np.abs(phase) >= 0.5)[0]:
        sinc[j], versine[j], cubic[j] = phase_functions(float(phase[j]))
    return sinc, versine, cubic


@dataclass(frozen=True)
class Cwh(SteadyMotion):
    """The motion near a target on a circular orbit of ``mean_motion`` rad/s; raises ``InvalidInput`` out of range."""

    mean_motion: float

    def __post_init__(self) -> None:
        number("mean_motion", self.mean_motion, 0.0, MAX_MEAN_MOTION)

    def transition(self, t0: float, t1: float) -> Floats:
        """Phi(t1 - t0)."""
        return transition_matrix(self.mean_motion, t1 - t0)

    def held(self, t0: float, t1: float) -> Floats:
        """B_d(t1 - t0)."""
        return input_matrix(self.mean_motion, t1 - t0)

    def moves(self, begin: Floats, end: Floats) -> tuple[Floats, Floats]:
        """Phi and B_d of many intervals, (J, 6, 6) and (J, 6, 3)."""
        return moves_of(self.mean_motion, end - begin)

    def positions(self, tau: Floats, dimensions: int) -> tuple[Floats, Floats]:
        """Position rows of Phi(tau) and B_d(tau)."""
        return position_matrices(self.mean_motion, tau, dimensions)


def cwh_of(target: Target) -> Cwh:
    """The motion near a scenario's target."""
    return Cwh(target.mean_motion)


_PLANE = np.array([0, 1, 3, 4])


def planar_transition(mean_motion: float, tau: float) -> Floats:
    """Phi(tau) of the planar state (x, y, vx, vy), shape (4, 4)."""
    planar: Floats = transition_matrix(mean_motion, tau)[np.ix_(_PLANE, _PLANE)]
    return planar


def planar_input(mean_motion: float, tau: float) -> Floats:
    """B_d(tau) of the planar state, shape (4, 2)."""
    planar: Floats = input_matrix(mean_motion, tau)[_PLANE, :2]
    return planar


def position_matrices(mean_motion: float, tau: Floats, dimensions: int) -> tuple[Floats, Floats]:
    """Position rows of Phi(tau), (J, d, 2 d), and of B_d(tau), (J, d, d), for J times in seconds."""
    d, count = dimensions, len(tau)
    p = mean_motion * tau
    if count and float(np.abs(p).max()) > 0.5:
        keep = np.r_[0:d, 3 : 3 + d]
        n, each = mean_motion, tau.tolist()
        return (
            np.array([transition_matrix(n, t)[:d, keep] for t in each]),
            np.array([input_matrix(n, t)[:d, :d] for t in each]),
        )
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


# The series' quotients of neighbouring terms: [k] holds those of sin(p)/p, 2 (1 - cos p)/p^2 and 6 (p - sin p)/p^3.
_QUOTIENTS = np.array([[[(2.0 * k + j) * (2.0 * k + j + 1.0)] for j in (2, 3, 4)] for k in range(6)])


def _phases(phase: Floats) -> tuple[Floats, Floats, Floats]:
    """sin(p)/p, (1 - cos p)/p^2 and (p - sin p)/p^3, by series: exact at 0, to 1e-16 for |p| <= 0.5."""
    square = phase * phase
    # The first omitted term is below p^8 / 9! < 3e-18 for p^2 < 1e-3, below p^14 / 15! < 5e-17 for |p| <= 0.5.
    terms = 3 if not len(phase) or float(square.max()) < 1e-3 else 6
    series = np.ones((3, len(phase)))
    for quotients in _QUOTIENTS[terms - 1 :: -1]:
        series = 1.0 - square / quotients * series
    return series[0], series[1] / 2.0, series[2] / 6.0

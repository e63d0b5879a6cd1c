"""The flight that is at the hold point at every node, with thrust held between them; in the plane, exact.

With body and LVLH aligned at angle theta, a point turning with the body is Re(e^(i theta) P), P = (h_x + i h_y,
h_y - i h_x). For CWH x(k+1) = A x(k) + B u(k) a reference of this form needs

    (z I - A) (P, V) = B c,   z = e^(i omega dt),

four complex equations for the velocity V and the thrust c. The nodes' velocity is not exactly omega x r: held thrust
flies short arcs through the nodes.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.errors import invalid
from safestart.model.scenario import Floats

Complexes = NDArray[np.complex128]
FASTEST = 1.0


@dataclass(frozen=True, slots=True)
class TurningReference:
    """Phasors of state (4,) and thrust (2,); ``rate`` rad/s, ``step`` s; Re(e^(i theta) .) at angle theta."""

    rate: float
    step: float
    mean_motion: float
    state: Complexes
    thrust: Complexes

    @classmethod
    def of(cls, point: Floats, rate: float, mean_motion: float, step: float) -> TurningReference:
        """For a body-frame ``point`` (2,), m. Raises ``InvalidInput`` when the target turns over 1 rad in a step."""
        if not 0.0 < step * max(rate, 1e-9) <= FASTEST:
            raise invalid("dt_s", f"a step in which the target turns {FASTEST:g} rad at most", step)
        a, b = planar_transition(mean_motion, step), planar_input(mean_motion, step)
        place = np.array([point[0] + 1j * point[1], point[1] - 1j * point[0]])
        moved = cmath.exp(1j * rate * step) * np.eye(4) - a
        found = np.linalg.solve(np.concatenate([moved[:, 2:], -b], axis=1), -moved[:, :2] @ place)
        return cls(rate, step, mean_motion, np.concatenate([place, found[:2]]), found[2:])

    def at(self, angle: float) -> tuple[Floats, Floats]:
        """State (4,) and thrust (2,), LVLH, at a node where the body is ``angle`` rad ahead of LVLH."""
        turn = cmath.exp(1j * angle)
        return (turn * self.state).real, (turn * self.thrust).real

    @property
    def most_thrust(self) -> float:
        """Largest |u| over all angles: max |Re(e^(i theta) c)|^2 = (|c|^2 + |c . c|) / 2."""
        return largest_of(self.thrust)

    def most_speed(self, tau: float) -> float:
        """Largest LVLH speed over all angles, m/s, ``tau`` s after a node."""
        a, b = planar_transition(self.mean_motion, tau), planar_input(self.mean_motion, tau)
        return largest_of(a[2:] @ self.state + b[2:] @ self.thrust)

    def between(self, tau: float) -> tuple[Floats, float]:
        """Where the body sees the reference ``tau`` s after a node: within a radius, m, of a point (2,)."""
        a, b = planar_transition(self.mean_motion, tau), planar_input(self.mean_motion, tau)
        x, y = a[:2] @ self.state + b[:2] @ self.thrust
        # x + i y = e^(i theta) (X + i Y) / 2 + e^(-i theta) conj(X - i Y) / 2.
        turning = cmath.exp(-1j * self.rate * tau) * (x + 1j * y) / 2.0
        return np.array([turning.real, turning.imag]), float(abs(x - 1j * y) / 2.0)


def largest_of(phasor: Complexes) -> float:
    """Largest |Re(e^(i theta) phasor)| over all theta."""
    squared = float(np.vdot(phasor, phasor).real + abs(phasor @ phasor))
    return math.sqrt(0.5 * squared)

"""LQR about the turning reference: u = u_ref - K (x - x_ref), K from the Riccati equation of sampled CWH."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, solve_discrete_are

from safestart.control.controller import Command
from safestart.control.hold.turning_reference import TurningReference
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.errors import invalid
from safestart.model.scenario import Floats

_PLANE = [0, 1, 3, 4]
_SOLVABLE = "scales for which the Riccati equation has a solution"


@dataclass(frozen=True, slots=True)
class Design:
    """Gain K (2, 4), closed loop F = A - B K (4, 4), cost P (4, 4); the error is LVLH, m and m/s."""

    gain: Floats
    closed_loop: Floats
    cost: Floats

    @classmethod
    def of(cls, mean_motion: float, step: float, position: float, velocity: float, thrust: float) -> Design:
        """Weights are 1 / scale^2 of position (m), velocity (m/s) and thrust (m/s^2).

        F' P F = P - Q - K' R K, so that e' P e never grows. Raises ``InvalidInput`` if the equation has no solution in
        float64 at these scales.
        """
        a, b = planar_transition(mean_motion, step), planar_input(mean_motion, step)
        state = np.diag([position**-2] * 2 + [velocity**-2] * 2)
        effort = np.eye(2) * thrust**-2
        try:
            cost = solve_discrete_are(a, b, state, effort)
            gain = np.linalg.solve(effort + b.T @ cost @ b, b.T @ cost @ a)
        except LinAlgError as error:
            raise invalid("position_scale_m", _SOLVABLE, position) from error
        closed = a - b @ gain
        cost = 0.5 * (cost + cost.T)
        grown = float(np.linalg.eigvalsh(closed.T @ cost @ closed - cost)[-1])
        if not (np.linalg.eigvalsh(cost)[0] > 0.0 and grown < 0.0):
            raise invalid("position_scale_m", _SOLVABLE, position)
        return cls(np.asarray(gain, dtype=np.float64), closed, np.asarray(cost, dtype=np.float64))


def hold_of(
    gain: Floats, cost: Floats, point: Floats, rate: float, mean_motion: float, step: float, most: float
) -> HoldLqr:
    """The hold of a terminal set: thrust = reference + ``gain`` (2, 4) error, the reference at ``point`` (2,), m, of a
    body that turns at ``rate`` rad/s and is aligned with LVLH at interval 0; ``step`` s, ``most`` m/s^2."""
    closed = planar_transition(mean_motion, step) + planar_input(mean_motion, step) @ gain
    reference = TurningReference.of(point, rate, mean_motion, step)
    return HoldLqr(Design(-gain, closed, cost), reference, 0.0, most)


class HoldLqr:
    """The controller, planar; ``phase`` rad is the body's angle at the start. It cuts no command: see the sets.

    ``most`` m/s^2: a command above it is reported as not feasible.
    """

    def __init__(self, design: Design, reference: TurningReference, phase: float, most: float) -> None:
        self._design, self._reference, self._phase, self._most = design, reference, phase, most

    def begin(self, state: Floats) -> None:
        """Nothing to forget."""

    def command(self, k: int, state: Floats) -> Command:
        """See :class:`safestart.control.controller.Controller`."""
        wanted, thrust = self._reference.at(self._phase + self._reference.rate * self._reference.step * k)
        plane = thrust - self._design.gain @ (state[_PLANE] - wanted)
        return Command(np.array([*plane, 0.0]), feasible=math.hypot(*plane) <= self._most, label="hold")

"""What the three-regime controller keeps for ever by its own hold: its law, filter and switches, in the plane.

In the hold regime the nominal command is (-kp (p - h) - kd v_body) turned into LVLH, plus the exact terms of the
turning frame and of CWH. The gains are the same in every direction, so in LVLH it is linear with constant numbers,
u_nom = N x + kp h(theta), h(theta) the hold point. Where no row of the filter binds, the filter gives

    u = (u_nom + w_du u_prev) / s,   s = 1 + w_u + w_du,

so that (x, u_prev) moves by a constant matrix F, driven by h(theta). It settles near h on a reference that turns with
the body, Re(e^(i theta) S) with (z I - F) S = b, and errors obey e(k+1) = F e(k). A sublevel set of e' P e, P from the
Lyapunov equation of F, is kept for ever if in all of it

- the regime is hold at the node (range within the band and within r_sync, body-frame speed under v_switch),
- no row of the filter's forecast binds, and the command is no longer than the thrust limit,
- every face is kept at all times.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from safestart.constraints.corridor import corridor_of
from safestart.control.gains import Gains
from safestart.control.hold.loop import Loop, Room
from safestart.control.hold.turning_reference import FASTEST, Complexes, TurningReference, largest_of
from safestart.control.regimes import Law, control_law
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.errors import invalid
from safestart.model.scenario import Floats, Scenario

_SETTLED = 1.0 - 1e-6
"""Spectral radius up to which the Lyapunov equation is well conditioned."""
_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])


@dataclass(frozen=True, slots=True)
class RegimeHold(Loop):
    """The loop in the errors (x, y, vx, vy, ux, uy) of state and previous command, LVLH.

    ``previous`` (2,) is the phasor of the reference's previous command, ``law`` and ``gains`` the controller's,
    ``nodes`` the length of its forecast.
    """

    previous: Complexes
    law: Law
    gains: Gains
    nodes: int

    @classmethod
    def of(
        cls, scenario: Scenario, gains: Gains, step: float, nodes: int, position: float, velocity: float
    ) -> RegimeHold:
        """The weights of P are 1 / scale^2 of position (m), velocity (m/s) and, for the previous command, the thrust
        limit.

        Raises ``InvalidInput`` when the target turns over 1 rad in a step.
        """
        law = control_law(scenario, gains, step)
        n, rate, most = law.mean_motion, law.tumble_rate, law.max_acceleration
        if not step * max(rate, 1e-9) <= FASTEST:
            raise invalid("dt_s", f"a step in which the target turns {FASTEST:g} rad at most", step)
        rows = _feedback(law, gains)
        b = planar_input(n, step)
        closed = np.vstack([np.hstack([planar_transition(n, step), np.zeros((4, 2))]) + b @ rows, rows])
        # kp h(theta), the hold point as a phasor.
        point = np.array([1j, 1.0]) * law.hold_range
        wanted = _share(gains) * law.kp_hold * point
        driven = np.concatenate([b, np.eye(2)]) @ wanted
        moved = cmath.exp(1j * rate * step) * np.eye(6) - closed
        settled = np.asarray(np.linalg.solve(moved, driven), dtype=np.complex128)
        thrust = np.asarray(rows @ settled + wanted, dtype=np.complex128)
        reference = TurningReference(rate, step, n, settled[:4], thrust)
        weights = np.diag([position**-2] * 2 + [velocity**-2] * 2 + [most**-2] * 2)
        cost = _cost(closed, weights)
        corridor = corridor_of(scenario.corridor)
        return cls(reference, corridor, most, rows, closed, cost, settled[4:], law, gains, nodes)

    def at(self, error: Floats, angle: float) -> Floats:
        """State (4,), LVLH, and previous command (2,), of an error (6,) where the body is at ``angle``, rad."""
        turn = cmath.exp(1j * angle)
        return np.asarray(error + (turn * np.concatenate([self.reference.state, self.previous])).real)

    @property
    def spectral_radius(self) -> float:
        """Of F. From 1 on errors do not shrink."""
        return _radius(self.closed)

    @property
    def stable(self) -> bool:
        """Whether errors shrink, and P was found; ``cost`` is 0 where not."""
        return bool(self.cost.any())

    @property
    def usable(self) -> float:
        """Thrust that the filter gives uncut, m/s^2."""
        return self.most * min(1.0, self.gains.disk_limit)

    def conditions(self) -> tuple[Room, ...]:
        """The regime's switches at a node, and the filter's rows: none may bind."""
        law, reference = self.law, self.reference
        place, radius = reference.between(0.0)
        near, far = math.hypot(*place) - radius, math.hypot(*place) + radius
        position = self.reach_of(np.eye(2, 6))
        spin = np.hstack([-law.tumble_rate * _TURN, np.eye(2), np.zeros((2, 2))])
        speed = largest_of(spin[:, :4] @ reference.state)
        band = law.hold_band - max(far - law.hold_range, law.hold_range - near)
        out = [
            Room("hold_band", band, position),
            Room("sync_radius", law.sync_radius - far, position),
            Room("switch_speed", law.switch_speed - speed, self.reach_of(spin)),
        ]
        offsets = (self.corridor.offsets - self.gains.corridor_margin) / self.corridor.lengths
        normals = self.corridor.normals / self.corridor.lengths[:, None]
        for j in range(1, self.nodes + 1):
            tau = j * reference.step
            place, radius = reference.between(tau)
            reach = self.reach_of(self.moved(tau))
            out += [Room("filter", room, reach) for room in (offsets - normals @ place - radius).tolist()]
        return (*out, *self._one_step())

    def _one_step(self) -> tuple[Room, ...]:
        """The filter's rows about the next node: keep-out and speed, where they are on."""
        out, reference = [], self.reference
        step = reference.step
        if self.gains.keep_out_radius > 0.0:
            # e . p_1 with e along the free drift, which is at most |B| a_max from p_1.
            pushed = float(np.linalg.norm(planar_input(reference.mean_motion, step)[:2], 2)) * self.most
            place, radius = reference.between(step)
            room = math.hypot(*place) - radius - 2.0 * pushed - self.gains.keep_out_radius
            out.append(Room("filter", room, self.reach_of(self.moved(step))))
        if self.gains.speed_limit > 0.0:
            room = self.gains.speed_limit - reference.most_speed(step)
            out.append(Room("filter", room, self.reach_of(self.moved(step, velocity=True))))
        return tuple(out)


def _share(gains: Gains) -> float:
    return 1.0 / (1.0 + gains.effort_weight + gains.move_weight)


def _feedback(law: Law, gains: Gains) -> Floats:
    """Rows (2, 6): the filtered command's dependence on state and previous command.

    R(theta) (-kd u + 2 omega x u + omega x (omega x q) - kp q) with u = v - omega x p, less CWH's own acceleration.
    """
    n, rate = law.mean_motion, law.tumble_rate
    position = (rate**2 - law.kp_hold) * np.eye(2) + law.kd_hold * rate * _TURN
    velocity = 2.0 * rate * _TURN - law.kd_hold * np.eye(2)
    tide = np.array([[3.0 * n * n, 0.0, 0.0, 2.0 * n], [0.0, 0.0, -2.0 * n, 0.0]])
    return _share(gains) * np.hstack([np.hstack([position, velocity]) - tide, gains.move_weight * np.eye(2)])


def _cost(closed: Floats, weights: Floats) -> Floats:
    """P with P - F' P F = Q; 0 where there is none in float64."""
    if _radius(closed) < _SETTLED:
        cost = solve_discrete_lyapunov(closed.T, weights)
        cost = 0.5 * (cost + cost.T)
        if (
            np.linalg.eigvalsh(cost)[0] > 0.0
            and np.linalg.eigvalsh(closed.T @ cost @ closed - cost)[-1] < 0.0
        ):
            return np.asarray(cost)
    return np.zeros_like(weights)


def _radius(closed: Floats) -> float:
    return float(np.abs(np.linalg.eigvals(closed)).max())

"""An attitude relative to LVLH from one relative to inertial axes, on any orbit: C(t) = C_inertial(t) R(t)^T.

The inertial axes are those of LVLH at t = 0 (:mod:`safestart.model.orbit`), so both attitudes agree at t = 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from safestart.attitude.body_frame import into_body
from safestart.attitude.quaternion import matrix_of, unit_quaternion
from safestart.attitude.torque_free import Inertia, TorqueFree
from safestart.attitude.turning import Bounds, SmoothAttitude, of_rates, product
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import Floats

Reference = Literal["inertial", "lvlh"]


@dataclass(frozen=True)
class InLvlh:
    """``inertial``, an attitude relative to inertial axes, expressed relative to LVLH on ``orbit``."""

    inertial: SmoothAttitude
    orbit: KeplerOrbit

    def rotation(self, times: Floats) -> Floats:
        """(..., 3, 3): LVLH coordinates to body coordinates."""
        return self._seen(self.inertial.rotation(times), times)

    def _seen(self, inertial: Floats, times: Floats) -> Floats:
        # Times last, the memory order.
        seen, angle = np.moveaxis(inertial, (-2, -1), (0, 1)), self.orbit.turned(times)
        out = np.empty(seen.shape)
        # The columns of C R^T: R turns about z.
        out[:, 0], out[:, 1] = into_body(np.cos(angle), np.sin(angle), seen[:, 0], seen[:, 1])
        out[:, 2] = seen[:, 2]
        return np.moveaxis(out, (0, 1), (-2, -1))

    def angular_velocity(self, times: Floats) -> Floats:
        """(..., 3), rad/s, of the body against LVLH, in body axes."""
        return self._velocity(self.inertial.rotation(times), times)

    def _velocity(self, inertial: Floats, times: Floats) -> Floats:
        normal, rate = inertial[..., 2], self.orbit.rate(times)
        out: Floats = self.inertial.angular_velocity(times) - rate[..., None] * normal
        return out

    def moving(self, times: Floats) -> tuple[Floats, Floats]:
        """:meth:`rotation` and :meth:`angular_velocity`; the inertial rotation, which takes longest, is made once."""
        inertial = self.inertial.rotation(times)
        return self._seen(inertial, times), self._velocity(inertial, times)

    def rate_bounds(self) -> tuple[float, float]:
        """Bounds on |omega| (rad/s) and |omega dot| (rad/s^2): the sums of those of the body and of LVLH."""
        fast, changing = self.inertial.rate_bounds()
        turning, bending = self.orbit.rate_bounds()
        return fast + turning, changing + bending + fast * turning

    @property
    def knots(self) -> Floats:
        """The knots of the inertial attitude, s."""
        return self.inertial.knots

    def turn_bounds(self) -> Bounds:
        """Bounds on the derivatives of the product of both turns, the body's and LVLH's."""
        return product(of_rates(*self.orbit.turn_bounds()), self.inertial.turn_bounds())


def torque_free(
    inertia: Inertia,
    attitude: tuple[float, float, float, float],
    body_rate: tuple[float, float, float],
    reference: Reference,
    orbit: KeplerOrbit,
) -> InLvlh:
    """A torque-free body relative to LVLH.

    ``attitude`` (scalar first) leads from LVLH to the body at t = 0, where the inertial axes agree with LVLH.
    ``body_rate`` (rad/s, body axes) is against ``reference``: inertial axes or LVLH at t = 0; the motion is torque-free
    in inertial space either way. Raises ``InvalidInput`` as :class:`TorqueFree` does.
    """
    if reference == "lvlh":
        normal = matrix_of(np.array(unit_quaternion("attitude", attitude)))[:, 2]
        w = np.asarray(body_rate, dtype=np.float64) + float(orbit.rate(np.zeros(()))) * normal
        body_rate = (float(w[0]), float(w[1]), float(w[2]))
    return InLvlh(TorqueFree(inertia, attitude, body_rate), orbit)

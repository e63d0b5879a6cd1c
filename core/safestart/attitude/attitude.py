"""How the target turns: the interface of every attitude, and the conversion of states to the body frame.

The body frame has its origin in the target, like LVLH. Times are seconds since the flight's start.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from safestart.model.scenario import Floats


class Attitude(Protocol):
    """A turning body frame."""

    def rotation(self, times: Floats) -> Floats:
        """(..., 3, 3) for times (...): LVLH coordinates to body coordinates."""
        ...

    def angular_velocity(self, times: Floats) -> Floats:
        """(..., 3), rad/s, of the body against LVLH, in body axes."""
        ...

    def rate_bounds(self) -> tuple[float, float]:
        """Upper bounds, at all times, on the size of the angular velocity (rad/s) and of its derivative (rad/s^2)."""
        ...


def to_body(attitude: Attitude, times: Floats, states: Floats) -> Floats:
    """LVLH states (T, 6) at ``times`` (T,) in the body frame: R p and R v - omega x R p, (T, 6)."""
    turn, omega = attitude.rotation(times), attitude.angular_velocity(times)
    position = _applied(turn, states[:, :3])
    velocity = _applied(turn, states[:, 3:]) - np.cross(omega, position)
    return np.concatenate([position, velocity], axis=1)


def to_lvlh(attitude: Attitude, times: Floats, states: Floats) -> Floats:
    """Inverse of :func:`to_body`."""
    turn, omega = attitude.rotation(times), attitude.angular_velocity(times)
    velocity = states[:, 3:] + np.cross(omega, states[:, :3])
    back = turn.swapaxes(1, 2)
    return np.concatenate([_applied(back, states[:, :3]), _applied(back, velocity)], axis=1)


def _applied(matrices: Floats, vectors: Floats) -> Floats:
    """Matrices (T, 3, 3) times vectors (T, 3), written out so that a spin about z rounds like the planar formulas."""
    out: Floats = matrices[:, :, 0] * vectors[:, 0, None]
    return out + matrices[:, :, 1] * vectors[:, 1, None] + matrices[:, :, 2] * vectors[:, 2, None]

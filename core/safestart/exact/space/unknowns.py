"""What is not known of a question in space, beside the start: one thrust history has to suit every member.

Members differ from what the question states by the body's attitude and rate at t = 0, by its inertia, and by an
acceleration of the chaser that changes in any way over time.
"""

from __future__ import annotations

from dataclasses import dataclass

from safestart.model.scenario import number

MOST_ANGLE, MOST_RATE, MOST_INERTIA, MOST_DISTURBANCE = 0.6, 0.1, 0.3, 1.0


@dataclass(frozen=True, slots=True)
class Unknowns:
    """Bounds; all 0: everything is known. Raises ``InvalidInput`` for a bound out of range.

    ``angle`` (rad) between a member's attitude and the stated one at t = 0. ``rate`` (rad/s): the size of the
    difference of their angular velocities in body axes, at t = 0 of a torque-free body, at all times of others.
    ``inertia``: share by which each moment about the body's axes (the tensor's diagonal) may differ; torque-free only.
    ``disturbance`` (m/s^2): size of an acceleration of the chaser, any function of time.
    """

    angle: float = 0.0
    rate: float = 0.0
    inertia: float = 0.0
    disturbance: float = 0.0

    def __post_init__(self) -> None:
        number("angle", self.angle, 0.0, MOST_ANGLE)
        number("rate", self.rate, 0.0, MOST_RATE)
        number("inertia", self.inertia, 0.0, MOST_INERTIA)
        number("disturbance", self.disturbance, 0.0, MOST_DISTURBANCE)

    @property
    def turns(self) -> bool:
        """Whether the attitude is not known."""
        return max(self.angle, self.rate, self.inertia) > 0.0

    def __bool__(self) -> bool:
        """Whether anything is unknown."""
        return max(self.angle, self.rate, self.inertia, self.disturbance) > 0.0


KNOWN = Unknowns()

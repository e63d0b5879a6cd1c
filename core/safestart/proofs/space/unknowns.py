"""What a document in space says is not known beside the start, read strictly. Part of the checker."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from flint import fmpq

from safestart.proofs.space.parts import Attitude
from safestart.proofs.strict import ProofRejected, fields, number

_KEYS = ("attitude_rad", "rate_rad_s", "inertia_share", "disturbance_m_s2")


@dataclass(frozen=True, slots=True)
class Unknowns:
    """Bounds on a member's attitude (rad) and rate (rad/s) beside those stated, on the share by which each moment about
    the body's axes differs, and on an acceleration of the chaser (m/s^2) that changes in any way over time."""

    angle: fmpq
    rate: fmpq
    inertia: fmpq
    disturbance: fmpq

    @property
    def turns(self) -> bool:
        """Whether the attitude is not known."""
        return bool(self.angle > 0 or self.rate > 0 or self.inertia > 0)


def unknowns_of(said: Any, attitude: Attitude) -> Unknowns:
    """The bounds; raises :class:`ProofRejected`."""
    fields(said, "unknowns", _KEYS)
    angle, rate, inertia, disturbance = (
        number(said, key, 0.0, most) for key, most in zip(_KEYS, (1.0, 1.0, 0.5, 10.0), strict=True)
    )
    if inertia > 0 and attitude.kind != "torque_free":
        raise ProofRejected(f"inertia_share: required 0 for the attitude {attitude.kind}")
    return Unknowns(angle, rate, inertia, disturbance)

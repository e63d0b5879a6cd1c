"""A course of attitudes between two named frames: what an AEM, an APM or a table comes to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.errors import InvalidInput, invalid
from safestart.interchange.epochs import Nanoseconds, system_of, text_of
from safestart.interchange.frames import INERTIAL, frame_of
from safestart.model.scenario import Floats

ORBITAL = ("RTN", "RSW")
"""Names of axes radial, along-track, cross-track: our LVLH."""


@dataclass(frozen=True)
class AttitudeCourse:
    """``quaternions`` (K, 4), scalar first, of unit length, at TAI ``epochs`` (K,), ns, that rise.

    They lead from ``reference``, one of the inertial frames or ``RTN``, to the body: r_B = C r_A
    (:mod:`safestart.attitude.quaternion`). Raises ``InvalidInput`` for epochs that do not rise and quaternions whose
    length is more than 1e-3 from 1 (wrong order, wrong columns).
    """

    name: str
    object_id: str
    reference: str
    body: str
    time_system: str
    epochs: Nanoseconds
    quaternions: Floats

    def __post_init__(self) -> None:
        object.__setattr__(self, "reference", reference_of(self.reference))
        _require_body(self.body)
        system_of(self.time_system)
        count = len(self.epochs)
        if count < 1 or self.quaternions.shape != (count, 4):
            raise invalid("quaternions", "at least one epoch and as many quaternions", self.quaternions.shape)
        steps = np.diff(self.epochs)
        if (steps <= 0).any():
            k = int(np.argmax(steps <= 0))
            before, after = text_of(self.epochs[k : k + 2], self.time_system)
            raise invalid("epochs", "epochs that rise", f"{after} after {before}")
        length = np.sqrt(np.square(self.quaternions).sum(axis=1))
        wrong = ~(np.abs(length - 1.0) <= 1e-3)
        if wrong.any():
            k = int(np.argmax(wrong))
            raise invalid("quaternions", "length 1 within 0.001", f"{length[k]:g} in entry {k + 1}")


def _require_body(name: str) -> None:
    """Raise ``InvalidInput`` for axes that are those of no body: an attitude of a frame says nothing of the target."""
    plain = name.upper().replace("_", "").replace("-", "").replace(" ", "")
    axes = ("LVLH", "RTN", "RSW", "RIC", "NTW", "TNW", "QSW", "PQW", "TOD", "MOD")
    known = plain.startswith((*axes, "ITRF")) or plain in ("GCRF", "ICRF", "EME2000", "J2000", "TEME", "GTOD")
    if not plain or known:
        raise invalid("REF_FRAME_B", "the body's axes (SC_BODY_1 or another name)", name)


def reference_of(name: str) -> str:
    """An inertial frame or RTN by this name; raises ``InvalidInput`` for one that is not known or not one thing."""
    plain = name.upper().replace("_ROTATING", "")
    if plain in ORBITAL:
        return "RTN"
    required = (
        f"one of {', '.join(INERTIAL)}, {', '.join(ORBITAL)} (LVLH has different axes in different documents)"
    )
    try:
        frame = frame_of(name)
    except InvalidInput:
        raise invalid("REF_FRAME", required, name) from None
    if frame not in INERTIAL:
        raise invalid("REF_FRAME", required, name)
    return frame

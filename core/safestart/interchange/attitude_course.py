"""A course of attitudes between two named frames: what an AEM, an APM or a table comes to."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass

import numpy as np

from safestart.errors import InvalidInput, invalid
from safestart.interchange.epochs import SECOND, Nanoseconds, system_of, text_of
from safestart.interchange.frames import INERTIAL, frame_of
from safestart.model.plain_text import require_line
from safestart.model.scenario import Bools, Floats

Window = tuple[int, int]
LONGEST_GAP_S = 300.0
"""A larger distance between entries is a gap, as between states."""
LARGEST_TURN = math.radians(90.0)
"""Beyond so much between two entries, which way a body turned is ambiguous."""
ORBITAL = ("RTN", "RSW")
"""Names of axes radial, along-track, cross-track: our LVLH."""


@dataclass(frozen=True)
class AttitudeCourse:
    """``quaternions`` (K, 4), scalar first, of unit length, at TAI ``epochs`` (K,), ns, that rise.

    They lead from ``reference``, one of the inertial frames or ``RTN``, to the body: r_B = C r_A
    (:mod:`safestart.attitude.quaternion`). Raises ``InvalidInput`` for epochs that do not rise and quaternions whose
    length is more than 1e-3 from 1 (wrong order, wrong columns). ``pieces`` are the indices at which a new segment
    begins, 0 first; ``useable`` has the first and last useable epoch of each segment, or None, or is empty.
    ``left_out`` names what the file holds besides.
    """

    name: str
    object_id: str
    reference: str
    body: str
    time_system: str
    epochs: Nanoseconds
    quaternions: Floats
    pieces: tuple[int, ...] = (0,)
    useable: tuple[Window | None, ...] = ()
    left_out: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for item, text in (
            ("OBJECT_NAME", self.name),
            ("OBJECT_ID", self.object_id),
            ("REF_FRAME_B", self.body),
        ):
            require_line(item, text)
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

    def spans(self) -> Nanoseconds:
        """(S, 2): first and last epochs, TAI, of the spans in which the attitude is known, in time.

        A span ends where a segment does, at the ends of what is useable, and before a gap: entries more than
        :data:`LONGEST_GAP_S` apart, or so far apart that the body, at its rate there or beside it, turns by more than
        :data:`LARGEST_TURN` in it. Slerp across one would make any body slow.
        """
        begins = sorted({*self.pieces, *(1 + np.nonzero(self._gaps())[0]).tolist()})
        found = []
        for first, after in zip(begins, [*begins[1:], len(self.epochs)], strict=True):
            begin, end = int(self.epochs[first]), int(self.epochs[after - 1])
            window = self.useable[bisect_right(self.pieces, first) - 1] if self.useable else None
            if window is not None:
                begin, end = max(begin, window[0]), min(end, window[1])
            if begin <= end:
                found.append((begin, end))
        return np.array(found, dtype=np.int64).reshape(-1, 2)

    def _gaps(self) -> Bools:
        """(K - 1,): whether nothing is known between an entry and the next."""
        seconds = np.diff(self.epochs) / SECOND
        turns = turns_of(self.quaternions)
        rates = np.concatenate([[0.0], turns / seconds, [0.0]])
        predicted = np.maximum(turns, np.maximum(rates[:-2], rates[2:]) * seconds)
        return np.asarray((seconds > LONGEST_GAP_S) | (predicted > LARGEST_TURN))


def turns_of(quaternions: Floats) -> Floats:
    """Angles (K - 1,), rad, between each of ``quaternions`` (K, 4) and the next: the shorter way."""
    product = np.abs(np.sum(quaternions[:-1] * quaternions[1:], axis=1))
    lengths = np.sqrt(np.square(quaternions).sum(axis=1))
    out: Floats = 2.0 * np.arccos(np.minimum(product / (lengths[:-1] * lengths[1:]), 1.0))
    return out


def require_dense(epochs: Nanoseconds, rates: Floats) -> None:
    """Raise ``InvalidInput`` where a body with ``rates`` (K,), rad/s, turns too far between two of ``epochs`` (K,).

    The entries alone cannot show that: after more than half a turn a body looks slower than it is.
    """
    turns = np.maximum(rates[:-1], rates[1:]) * np.diff(epochs) / SECOND
    if len(turns) and float(turns.max()) > LARGEST_TURN:
        k = int(np.argmax(turns))
        raise invalid(
            "attitude",
            "at most 90 degrees between two entries, at the file's own rates",
            f"{math.degrees(turns[k]):.4g} degrees after entry {k + 1}",
        )


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

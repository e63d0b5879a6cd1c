"""Frames around the Earth by name, and the conversion of their states to GCRF by ERFA, the IAU's library.

GCRF and ICRF have the same axes here. EME2000 (J2000) differs from them by the frame bias of some 0.02 arcseconds. TEME
is the true equator and mean equinox of date (IAU 1976 precession, IAU 1980 nutation), as SGP4 uses it. ITRF turns with
the Earth (IAU 2006/2000A) with UT1 taken as UTC and the pole where it is on average: the axes are within 7e-5 rad of
the true ones. Two states in ITRF have the same relative state in LVLH, up to 1e-7 of their distance; an attitude
against inertial axes beside them is refused (:mod:`safestart.interchange.relative`).
"""

from __future__ import annotations

import re

import numpy as np

from safestart.errors import Unavailable, invalid
from safestart.interchange.epochs import SECOND, Nanoseconds, leap_seconds
from safestart.model.orbit import about_z
from safestart.model.scenario import Floats

INERTIAL = ("GCRF", "ICRF", "EME2000", "TEME")
"""Frames that do not turn (TEME by 50 arcseconds a year)."""
_SAME = {
    "J2000": "EME2000",
    "EME2000": "EME2000",
    "GCRF": "GCRF",
    "ICRF": "ICRF",
    "TEME": "TEME",
    "TEMEOFDATE": "TEME",
}
EARTH_TURN = 7.292115146706979e-5
"""Rate of the Earth, rad/s (IERS)."""
_J2000_S = 43_200
"""2000-01-01T12:00:00 in seconds of the day."""
_TT_LESS_TAI = 32.184


def frame_of(name: str) -> str:
    """The frame of this name, in any spelling; ITRF keeps its realisation (ITRF97, ITRF2014).

    Raises ``InvalidInput`` for an unknown one.
    """
    plain = name.upper().replace("_", "").replace("-", "").replace(" ", "")
    if plain in _SAME:
        return _SAME[plain]
    found = re.fullmatch(r"ITRF(?:(?:19)?(8[89]|9\d)|(?:20)?([0-2]\d))?", plain, re.ASCII)
    if found is not None:
        return f"ITRF{found[1]}" if found[1] else f"ITRF20{found[2]}" if found[2] else "ITRF"
    raise invalid("REF_FRAME", f"one of {', '.join(INERTIAL)}, ITRF", name)


def turns_with_the_earth(frame: str) -> bool:
    """Whether it is a realisation of ITRF."""
    return frame.startswith("ITRF")


def require_comparable(chaser: str, target: str) -> None:
    """Raise ``InvalidInput`` for frames whose states have no relative state: ITRF beside another, or two realisations.

    The Earth's turn is not known well enough for the first; realisations differ by centimetres.
    """
    if chaser != target and (turns_with_the_earth(chaser) or turns_with_the_earth(target)):
        raise invalid(
            "REF_FRAME", "both courses in one realisation of ITRF, or neither in any", f"{chaser}, {target}"
        )


def to_gcrf(frame: str, epochs: Nanoseconds, states: Floats) -> Floats:
    """States (K, 6), m and m/s, at TAI epochs (K,), in GCRF. Raises ``InvalidInput``, ``Unavailable``."""
    frame = frame_of(frame)
    if frame in ("GCRF", "ICRF"):
        return states
    turn = rotation_to_gcrf(frame, epochs)
    position, velocity = states[:, :3], states[:, 3:]
    if turns_with_the_earth(frame):
        velocity = velocity + np.cross([0.0, 0.0, EARTH_TURN], position)
    turned = [np.einsum("kij,kj->ki", turn, part) for part in (position, velocity)]
    return np.concatenate(turned, axis=1)


def rotation_to_gcrf(frame: str, epochs: Nanoseconds) -> Floats:
    """(K, 3, 3): coordinates in ``frame`` to coordinates in GCRF at TAI epochs (K,)."""
    try:
        import erfa
    except ModuleNotFoundError:
        raise Unavailable(
            f"{frame} requires the package pyerfa (extra files)", required="the package pyerfa"
        ) from None
    frame = frame_of(frame)
    if frame in ("GCRF", "ICRF"):
        return np.broadcast_to(np.eye(3), (len(epochs), 3, 3))
    bias = np.asarray(erfa.bp06(2451545.0, 0.0)[0])
    if frame == "EME2000":
        return np.broadcast_to(bias.T, (len(epochs), 3, 3))
    first, day = 2451545.0, (np.asarray(epochs) / SECOND - _J2000_S + _TT_LESS_TAI) / 86_400.0
    if frame == "TEME":
        longitude, _ = erfa.nut80(first, day)
        equinoxes = np.asarray(longitude * np.cos(erfa.obl80(first, day)))
        tod = np.asarray(erfa.pnm80(first, day))
        # TEME to TOD turns by the equation of the equinoxes; the transposes lead on to EME2000 and GCRF.
        out: Floats = np.einsum("ji,kmj,kmn->kin", bias, tod, about_z(-equinoxes))
        return out
    days = np.asarray(epochs) // (86_400 * SECOND)
    utc = day - (_TT_LESS_TAI + leap_seconds(days)) / 86_400.0
    celestial = np.asarray(erfa.c2t06a(first, day, first, utc, 0.0, 0.0))
    return celestial.swapaxes(1, 2)

"""A flight in LVLH as files of the field: ephemerides of both craft, the target's attitude, burns, a scene for viewers.

A flight knows the target's mean motion and no orbit. The files put the target on a circular orbit over the equator, in
GCRF axes that LVLH has when the flight begins, at :data:`BEGIN`; read back, they give the same relative states.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from safestart.attitude.attitude import Attitude
from safestart.attitude.quaternion import quaternion_of
from safestart.errors import invalid
from safestart.interchange.attitude_course import AttitudeCourse
from safestart.interchange.ccsds import aem, kvn, ocm, oem
from safestart.interchange.ccsds.parameters import Manoeuvre, OrbitParameters, impulses, orbit_tokens
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND
from safestart.interchange.relative import lvlh_axes, to_inertial
from safestart.model.orbit import MU
from safestart.model.scenario import Floats

BEGIN = 43_200 * SECOND
"""2000-01-01T12:00:00 TAI: a flight has no date."""
CREATED = "2000-01-01T00:00:00"
"""The same bytes at any time."""
_SYSTEM = "TAI"


@dataclass(frozen=True)
class FlightCourses:
    """``chaser`` and ``target`` in GCRF, the target's ``attitude`` against GCRF, the chaser's ``burns`` in RTN."""

    chaser: Ephemeris
    target: Ephemeris
    attitude: AttitudeCourse
    burns: tuple[Manoeuvre, ...]

    def files(self) -> dict[str, bytes]:
        """The files by name."""
        start = Ephemeris(
            *(self.chaser.name, self.chaser.object_id, self.chaser.frame, _SYSTEM),
            self.chaser.epochs[:1],
            self.chaser.states[:1],
        )
        messages = {
            "chaser.oem": oem.tokens_of(self.chaser, CREATED),
            "target.oem": oem.tokens_of(self.target, CREATED),
            "target.aem": aem.tokens_of(self.attitude, CREATED),
            "chaser.opm": orbit_tokens(OrbitParameters(start, self.burns), CREATED),
            "chaser.ocm": ocm.tokens_of(self.chaser, self.burns, CREATED),
        }
        found = {name: kvn.text_of(tokens).encode() for name, tokens in messages.items()}
        return found | {"flight.czml": czml_of(self.chaser, self.target)}


def courses_of(
    times: Floats,
    states: Floats,
    thrust: Floats,
    mean_motion: float,
    attitude: Attitude,
    jumps: Floats | None = None,
) -> FlightCourses:
    """The courses of a flight: ``times`` (T,) s, ``states`` (T, 6) LVLH, ``thrust`` (T - 1, 3) m/s^2 from each on.

    ``attitude`` leads from LVLH to the body. Burns that follow one another with the same thrust are one. ``jumps``
    (T, 3), m/s: impulses at the times, after which the states are. Raises ``InvalidInput`` without a mean motion,
    where there is no orbit.
    """
    if not mean_motion > 0.0:
        raise invalid("mean_motion_rad_s", "more than 0 for files that hold an orbit", mean_motion)
    radius = (MU / mean_motion**2) ** (1.0 / 3.0)
    angle, zero = mean_motion * times, np.zeros(len(times))
    cosine, sine = np.cos(angle), np.sin(angle)
    target = radius * np.stack([cosine, sine, zero, -mean_motion * sine, mean_motion * cosine, zero], axis=1)
    epochs = BEGIN + np.rint(times * SECOND).astype(np.int64)
    turned = attitude.rotation(times) @ lvlh_axes(target)[0]
    quaternions = np.array([quaternion_of(turn) for turn in turned])
    return FlightCourses(
        Ephemeris("CHASER", "CHASER", "GCRF", _SYSTEM, epochs, to_inertial(states, target)),
        Ephemeris("TARGET", "TARGET", "GCRF", _SYSTEM, epochs, target),
        AttitudeCourse("TARGET", "TARGET", "GCRF", "SC_BODY_1", _SYSTEM, epochs, quaternions),
        _burns(times, thrust) + (() if jumps is None else impulses(times, jumps, BEGIN, 0.0)),
    )


def _burns(times: Floats, thrust: Floats) -> tuple[Manoeuvre, ...]:
    changes = np.r_[0, 1 + np.nonzero((np.diff(thrust, axis=0) != 0.0).any(axis=1))[0], len(thrust)]
    out: list[Manoeuvre] = []
    for first, last in pairwise(changes.tolist()):
        span = float(times[last] - times[first])
        out += impulses(times[first : first + 1], span * thrust[first : first + 1], BEGIN, span)
    return tuple(out)


def czml_of(chaser: Ephemeris, target: Ephemeris) -> bytes:
    """A CZML document of both craft in inertial axes, for CesiumJS and what reads its files; UTC is TAI - 32 s then."""
    begin, end = "2000-01-01T11:59:28Z", _later(int(chaser.epochs[-1] - chaser.epochs[0]) / SECOND)
    span = f"{begin}/{end}"
    clock = {"interval": span, "currentTime": begin, "multiplier": 1, "range": "LOOP_STOP"}
    packets: list[dict[str, Any]] = [
        {"id": "document", "name": "safestart flight", "version": "1.0", "clock": clock}
    ]
    for course, colour in ((target, [213, 94, 0, 255]), (chaser, [0, 114, 178, 255])):
        seconds = (course.epochs - course.epochs[0]) / SECOND
        rows = np.column_stack([seconds, course.states[:, :3]])
        packets.append(
            {
                "id": course.name,
                "name": course.name,
                "availability": span,
                "position": {
                    "epoch": begin,
                    "referenceFrame": "INERTIAL",
                    "interpolationAlgorithm": "LAGRANGE",
                    "interpolationDegree": 5,
                    "cartesian": rows.ravel().tolist(),
                },
                "point": {"pixelSize": 8, "color": {"rgba": colour}},
                "path": {"width": 1, "material": {"solidColor": {"color": {"rgba": colour}}}},
            }
        )
    return json.dumps(packets, allow_nan=False).encode()


def _later(seconds: float) -> str:
    """``seconds`` after 11:59:28, within the day."""
    microseconds = round((11 * 3600 + 59 * 60 + 28 + seconds) * 1e6)
    whole, part = divmod(microseconds, 1_000_000)
    return f"2000-01-01T{whole // 3600:02d}:{whole // 60 % 60:02d}:{whole % 60:02d}.{part:06d}Z"

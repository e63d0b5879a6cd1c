"""Messages of one epoch: OPM (state, covariance, manoeuvres) and APM (attitude), and OPM back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.errors import invalid
from safestart.interchange.attitude_course import AttitudeCourse
from safestart.interchange.ccsds.message import Message, header_of, key
from safestart.interchange.ccsds.tokens import Fields, Token, decimal, refused
from safestart.interchange.ccsds.xml_form import TRIANGLE
from safestart.interchange.covariance import Covariance, Sense, covariance_frame
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import epochs_of, shortened, text_of
from safestart.model.scenario import Floats

STATE = ("X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT")
_PASSED_OVER = (
    *(
        "REF_FRAME_EPOCH",
        "SEMI_MAJOR_AXIS",
        "ECCENTRICITY",
        "INCLINATION",
        "RA_OF_ASC_NODE",
        "ARG_OF_PERICENTER",
    ),
    *(
        "TRUE_ANOMALY",
        "MEAN_ANOMALY",
        "GM",
        "MASS",
        "SOLAR_RAD_AREA",
        "SOLAR_RAD_COEFF",
        "DRAG_AREA",
        "DRAG_COEFF",
    ),
)
_UNITS = ("km**2", "km**2/s", "km**2/s**2")


@dataclass(frozen=True)
class Manoeuvre:
    """A burn from TAI ``epoch``, ns, for ``duration`` s (0: an impulse) of ``delta_v`` (3,) m/s in ``frame``."""

    epoch: int
    duration: float
    delta_v: tuple[float, float, float]
    frame: str = "RTN"


@dataclass(frozen=True)
class OrbitParameters:
    """An OPM: a state as a course of one epoch, and manoeuvres."""

    state: Ephemeris
    manoeuvres: tuple[Manoeuvre, ...] = ()


def orbit_of(message: Message, sense: Sense | None = None) -> OrbitParameters:
    """The state, its covariance and the manoeuvres of an OPM. Raises ``InvalidInput``."""
    first, *burns = _blocks(message)
    system = first.get("TIME_SYSTEM")
    at = epochs_of([first.get("EPOCH")], system)
    values = [first.number(name, "km" if k < 3 else "km/s", 3) for k, name in enumerate(STATE)]
    frame = first.get("REF_FRAME")
    covariances: tuple[Covariance, ...] = ()
    if any(first.has(name) for name in TRIANGLE):
        matrix = np.zeros((6, 6))
        for name, (row, column) in zip(TRIANGLE, zip(*np.tril_indices(6), strict=True), strict=True):
            matrix[row, column] = matrix[column, row] = first.number(name, _UNITS[name.count("DOT")], 6)
        named = covariance_frame(first.get("COV_REF_FRAME", frame), sense)
        covariances = (Covariance(int(at[0]), named, matrix),)
    named_as = first.get("OBJECT_NAME"), first.get("OBJECT_ID")
    center = first.get("CENTER_NAME")
    first.done(_PASSED_OVER)
    beside = [name for name in _PASSED_OVER if first.has(name)]
    left_out = (*beside, *(("manoeuvres",) if burns else ()))
    state = Ephemeris(
        *named_as, frame, system, at, np.array([values]), covariances, (0,), center, left_out=left_out
    )
    return OrbitParameters(state, tuple(_burn(one, system) for one in burns))


def _burn(one: Fields, system: str) -> Manoeuvre:
    dv = [one.number(f"MAN_DV_{k}", "km/s", 3) for k in (1, 2, 3)]
    found = Manoeuvre(
        int(epochs_of([one.get("MAN_EPOCH_IGNITION")], system)[0]),
        one.number("MAN_DURATION", "s"),
        (dv[0], dv[1], dv[2]),
        one.get("MAN_REF_FRAME"),
    )
    one.done(("MAN_DELTA_MASS",))
    return found


def _blocks(message: Message) -> list[Fields]:
    found = []
    for one in message.blocks():
        if one.name or one.rows:
            raise refused(one.fields.line, f"keywords of {message.kind}", one.name or "a row of data")
        found.append(one.fields)
    if not found:
        raise invalid("file", f"the keywords of {message.kind}", "none (truncated)")
    return found


def orbit_tokens(found: OrbitParameters, created: str, originator: str = "SAFESTART") -> list[Token]:
    """An OPM 2.0; every number reads back as the same double."""
    state = found.state
    system = state.time_system
    out = header_of("OPM", "2.0", created, originator)
    out += [
        key("OBJECT_NAME", state.name),
        key("OBJECT_ID", state.object_id),
        key("CENTER_NAME", state.center),
    ]
    out += [key("REF_FRAME", state.frame), key("TIME_SYSTEM", system)]
    out.append(key("EPOCH", shortened(text_of(state.epochs[:1], system)[0])))
    for k, (name, value) in enumerate(zip(STATE, state.states[0].tolist(), strict=True)):
        out.append(key(name, decimal(value, 3), "km" if k < 3 else "km/s"))
    for one in state.covariances[:1]:
        out.append(key("COV_REF_FRAME", one.frame.replace("RTN", "RSW")))
        for name, value in zip(TRIANGLE, one.matrix[np.tril_indices(6)].tolist(), strict=True):
            out.append(key(name, decimal(value, 6), _UNITS[name.count("DOT")]))
    if found.manoeuvres:
        texts = text_of(np.array([burn.epoch for burn in found.manoeuvres]), system)
        for text, burn in zip(texts, found.manoeuvres, strict=True):
            out += [
                key("MAN_EPOCH_IGNITION", shortened(text)),
                key("MAN_DURATION", decimal(burn.duration), "s"),
            ]
            out += [key("MAN_DELTA_MASS", "0.0", "kg"), key("MAN_REF_FRAME", burn.frame)]
            out += [key(f"MAN_DV_{k}", decimal(dv, 3), "km/s") for k, dv in enumerate(burn.delta_v, 1)]
    return out


def attitude_of(message: Message) -> AttitudeCourse:
    """The quaternion of an APM, version 1 (keywords) or 2 (a block QUAT), as a course of one epoch.

    Raises ``InvalidInput`` for an APM without a quaternion.
    """
    plain, quaternion = Fields("APM"), None
    for one in message.blocks():
        if one.name in ("META", ""):
            for token in one.fields.values.values():
                plain.add(token)
        elif one.name == "QUAT":
            quaternion = one.fields
    if quaternion is None:
        quaternion, names = plain, ("Q_FRAME_A", "Q_FRAME_B")
    else:
        names = ("REF_FRAME_A", "REF_FRAME_B")
    turn = np.array([[quaternion.number(name, "") for name in ("QC", "Q1", "Q2", "Q3")]])
    if quaternion.get("Q_DIR", "A2B").upper() == "B2A":
        turn[:, 1:] *= -1.0
    system = plain.get("TIME_SYSTEM")
    epoch = epochs_of([plain.get("EPOCH")], system)
    frames = quaternion.get(names[0]), quaternion.get(names[1])
    return AttitudeCourse(plain.get("OBJECT_NAME"), plain.get("OBJECT_ID"), *frames, system, epoch, turn)


def impulses(times: Floats, delta_v: Floats, begin: int, duration: float) -> tuple[Manoeuvre, ...]:
    """Manoeuvres in LVLH at ``times`` (K,) s after TAI ``begin``, of ``delta_v`` (K, 3) m/s, none where it is 0."""
    return tuple(
        Manoeuvre(begin + round(time * 1e9), duration, (dv[0], dv[1], dv[2]))
        for time, dv in zip(times.tolist(), delta_v.tolist(), strict=True)
        if any(dv)
    )

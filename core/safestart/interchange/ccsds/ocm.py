"""Orbit Comprehensive Messages (502.0-B-3): trajectory and covariance as :class:`Ephemeris`, manoeuvres, and back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from safestart.errors import invalid
from safestart.interchange.attitude_course import Window
from safestart.interchange.ccsds.message import Block, Message, block, header_of, key
from safestart.interchange.ccsds.oem import triangle
from safestart.interchange.ccsds.parameters import Manoeuvre
from safestart.interchange.ccsds.tokens import Kind, Token, decimal, number, refused
from safestart.interchange.ccsds.useable import useable_keys, window_of
from safestart.interchange.covariance import Covariance, Sense, covariance_frame
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND, epochs_of, shortened, text_of

_TRAJECTORIES = {"CARTPV": 6, "CARTPVA": 9}
_MAN_UNITS = {"MAN_DURA": "s", "DV_X": "km/s", "DV_Y": "km/s", "DV_Z": "km/s"}
_MAN_COLUMNS = "TIME_ABSOLUTE, MAN_DURA, DV_X, DV_Y, DV_Z"


def ephemeris_of(message: Message, sense: Sense | None = None) -> Ephemeris:
    """The states of all TRAJ blocks (CARTPV, CARTPVA), each a piece, and the covariances (CARTPV, LTM).

    Raises ``InvalidInput``, by name for other types of trajectory, covariance and ordering.
    """
    meta: Block | None = None
    frame = center = ""
    latest = -(2**62)
    pieces: list[int] = []
    epochs: list[int] = []
    states: list[list[float]] = []
    covariances: list[Covariance] = []
    useable: list[Window | None] = []
    left_out: list[str] = []
    for one in message.blocks():
        if one.name == "META":
            meta = one
        elif meta is None:
            raise refused(one.fields.line, "META_START before data", one.name or "data")
        elif one.name == "TRAJ":
            latest = max([latest, *times_of(meta, one.rows)])
            named = one.fields.get("TRAJ_REF_FRAME"), one.fields.get("CENTER_NAME")
            if frame and named != (frame, center):
                raise refused(one.fields.line, "trajectories in one frame", named)
            frame, center = named
            pieces.append(len(epochs))
            useable.append(_useable(meta, one))
            width = _one_of(one, "TRAJ_TYPE", _TRAJECTORIES)
            left_out += ["accelerations"] if width == 9 else []
            _refuse_units(one, "TRAJ_UNITS", "km,km,km,km/s,km/s,km/s")
            if not one.rows:
                raise refused(one.fields.line, "states in TRAJ", "none (truncated)")
            epochs += times_of(meta, one.rows)
            states += [
                [number(text, row.line, "state", 3) for text in _columns(row, width)[:6]] for row in one.rows
            ]
        elif one.name in ("COV", "MAN"):
            latest = max([latest, *times_of(meta, one.rows)])
            if one.name == "MAN":
                left_out.append("manoeuvres")
                continue
            _one_of(one, "COV_TYPE", {"CARTPV": 6})
            _one_of(one, "COV_ORDERING", {"LTM": 21})
            _refuse_units(one, "COV_UNITS", "km**2")
            turned = covariance_frame(one.fields.get("COV_REF_FRAME"), sense)
            for at, row in zip(times_of(meta, one.rows), one.rows, strict=True):
                columns = iter(_columns(row, 21))
                rows = [[next(columns) for _ in range(size)] for size in range(1, 7)]
                covariances.append(Covariance(at, turned, triangle(rows, row.line)))
        else:
            left_out.append(f"block {one.name}")
    if meta is None or not epochs:
        raise invalid("file", "a trajectory (TRAJ_START)", "none (truncated)")
    name = meta.fields.get("OBJECT_NAME", "UNKNOWN")
    designator = meta.fields.get("OBJECT_DESIGNATOR", meta.fields.get("INTERNATIONAL_DESIGNATOR", "UNKNOWN"))
    system = meta.fields.get("TIME_SYSTEM")
    _refuse_truncated(meta, max(latest, epochs[-1]))
    at_all = np.array(epochs, dtype=np.int64)
    return Ephemeris(
        name,
        designator,
        frame,
        system,
        at_all,
        np.array(states),
        tuple(covariances),
        tuple(pieces),
        center,
        tuple(useable) if any(useable) else (),
        tuple(dict.fromkeys(left_out)),
    )


def _useable(meta: Block, one: Block) -> Window | None:
    names = ("USEABLE_START_TIME", "USEABLE_STOP_TIME")
    begin, end = (
        times_of(meta, [one.fields.values[name]])[0] if one.fields.has(name) else None for name in names
    )
    return window_of(begin, end, one.fields.line)


def _refuse_truncated(meta: Block, last: int) -> None:
    if meta.fields.has("STOP_TIME") and last < times_of(meta, [meta.fields.values["STOP_TIME"]])[0]:
        stop = meta.fields.get("STOP_TIME")
        raise refused(meta.fields.line, f"data up to STOP_TIME {stop}", "less (truncated)")


def manoeuvres_of(message: Message) -> tuple[Manoeuvre, ...]:
    """All burns of the MAN blocks, in the order of the file.

    MAN_COMPOSITION must hold a time and DV_X, DV_Y, DV_Z (km/s); MAN_DURA (s) is 0 where it is left out, and other
    columns are passed over. Raises ``InvalidInput``, by name for duty cycles other than CONTINUOUS.
    """
    meta: Block | None = None
    found: list[Manoeuvre] = []
    for one in message.blocks():
        if one.name == "META":
            meta = one
        if one.name != "MAN":
            continue
        if meta is None:
            raise refused(one.fields.line, "META_START before data", one.name)
        cycle = one.fields.get("DC_TYPE", "CONTINUOUS").upper()
        if cycle != "CONTINUOUS":
            raise refused(one.fields.line, "DC_TYPE CONTINUOUS", cycle)
        names = [name.strip().upper() for name in one.fields.get("MAN_COMPOSITION").split(",")]
        needed = [name for name in ("DV_X", "DV_Y", "DV_Z") if name not in names]
        if needed or names[0] not in ("TIME_ABSOLUTE", "TIME_RELATIVE"):
            asked = (
                "MAN_COMPOSITION: TIME_ABSOLUTE or TIME_RELATIVE first, then DV_X, DV_Y, DV_Z among others"
            )
            raise refused(one.fields.line, asked, ", ".join(names))
        for name, unit in zip(names, one.fields.columns_units("MAN_UNITS"), strict=False):
            required = _MAN_UNITS.get(name, unit)
            if unit.lower() != required.lower():
                raise refused(one.fields.line, f"{name} in {required}", unit)
        frame = one.fields.get("MAN_REF_FRAME")
        for at, row in zip(times_of(meta, one.rows), one.rows, strict=True):
            values = dict(zip(names[1:], _columns(row, len(names) - 1), strict=True))
            dv = [number(values[name], row.line, name, 3) for name in ("DV_X", "DV_Y", "DV_Z")]
            lasts = number(values["MAN_DURA"], row.line, "MAN_DURA") if "MAN_DURA" in values else 0.0
            found.append(Manoeuvre(at, lasts, (dv[0], dv[1], dv[2]), frame))
    return tuple(found)


def _one_of(one: Block, name: str, known: dict[str, int]) -> int:
    value = one.fields.get(name).upper()
    if value not in known:
        raise refused(one.fields.line, f"{name} {' or '.join(known)}", value)
    return known[value]


def _refuse_units(one: Block, name: str, required: str) -> None:
    given = ",".join(one.fields.columns_units(name)).lower()
    if given and not given.startswith(required):
        raise refused(one.fields.line, f"{name} [{required}]", given)


def _columns(row: Token, width: int) -> list[str]:
    _, *values = row.value.split()
    if len(values) != width:
        raise refused(row.line, f"a time and {width} numbers", f"{len(values)} numbers")
    return values


def times_of(meta: Block, rows: Sequence[Token]) -> list[int]:
    """TAI epochs of a block's rows, ns: absolute ones, or seconds after EPOCH_TZERO."""
    system = meta.fields.get("TIME_SYSTEM")
    zero = int(epochs_of([meta.fields.get("EPOCH_TZERO")], system)[0])
    texts = [row.value.split()[0] for row in rows]
    if all("T" in text for text in texts):
        return [int(at) for at in epochs_of(texts, system)]
    return [
        zero + round(number(text, row.line, "time") * SECOND) for text, row in zip(texts, rows, strict=True)
    ]


def tokens_of(
    ephemeris: Ephemeris, manoeuvres: Sequence[Manoeuvre], created: str, originator: str = "SAFESTART"
) -> list[Token]:
    """An OCM 3.0 of a course and its manoeuvres; every number reads back as the same double."""
    system = ephemeris.time_system
    out = header_of("OCM", "3.0", created, originator)
    texts = [shortened(text) for text in text_of(ephemeris.epochs, system)]
    meta = {"OBJECT_NAME": ephemeris.name, "INTERNATIONAL_DESIGNATOR": ephemeris.object_id}
    meta |= {"TIME_SYSTEM": system, "EPOCH_TZERO": texts[0], "START_TIME": texts[0], "STOP_TIME": texts[-1]}
    out += block("META", [key(*pair) for pair in meta.items()])
    ends = [*ephemeris.pieces[1:], len(texts)]
    for begin, end in zip(ephemeris.pieces, ends, strict=True):
        rows = [
            Token(
                Kind.ROW,
                value=" ".join([texts[k], *(decimal(value, 3) for value in ephemeris.states[k].tolist())]),
            )
            for k in range(begin, end)
        ]
        window = ephemeris.useable[ephemeris.pieces.index(begin)] if ephemeris.useable else None
        head = {"CENTER_NAME": ephemeris.center, "TRAJ_REF_FRAME": ephemeris.frame, "TRAJ_TYPE": "CARTPV"}
        head |= useable_keys(window, system)
        out += block("TRAJ", [*(key(*pair) for pair in head.items()), *rows])
    for one in ephemeris.covariances:
        at = shortened(text_of(np.array([one.epoch]), system)[0])
        numbers = [decimal(value, 6) for value in one.matrix[np.tril_indices(6)].tolist()]
        head = {"COV_REF_FRAME": one.frame.replace("RTN", "RSW"), "COV_TYPE": "CARTPV", "COV_ORDERING": "LTM"}
        out += block(
            "COV", [*(key(*pair) for pair in head.items()), Token(Kind.ROW, value=" ".join([at, *numbers]))]
        )
    if manoeuvres:
        starts = text_of(np.array([burn.epoch for burn in manoeuvres]), system)
        rows = [
            Token(
                Kind.ROW,
                value=" ".join(
                    [shortened(at), decimal(burn.duration), *(decimal(dv, 3) for dv in burn.delta_v)]
                ),
            )
            for at, burn in zip(starts, manoeuvres, strict=True)
        ]
        head = {
            "MAN_ID": "FLIGHT",
            "MAN_DEVICE_ID": "ALL",
            "MAN_REF_FRAME": "RSW_INERTIAL",
            "DC_TYPE": "CONTINUOUS",
        }
        head |= {"MAN_COMPOSITION": _MAN_COLUMNS, "MAN_UNITS": "[n/a, s, km/s, km/s, km/s]"}
        out += block("MAN", [*(key(*pair) for pair in head.items()), *rows])
    return out

"""Attitude Comprehensive Messages (504.0-B-2): the attitudes of the ATT blocks as :class:`AttitudeCourse`.

An ATT block leads from REF_FRAME_A to REF_FRAME_B and has its scalar last. Rates behind the quaternion are left out,
and so are the other blocks: covariances of attitudes, manoeuvres, the body, how the attitude was determined.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.errors import invalid
from safestart.interchange.attitude_course import AttitudeCourse, require_dense
from safestart.interchange.ccsds.message import Block, Message
from safestart.interchange.ccsds.ocm import times_of
from safestart.interchange.ccsds.tokens import number, refused

_ATT = ("ATT_ID", "ATT_PREV_ID", "ATT_BASIS", "ATT_BASIS_ID", "EULER_ROT_SEQ")
_OTHERS = ("PHYS", "COV", "MAN", "AD", "USER")
_UNITS = {"ANGVEL": math.radians(1.0), "Q_DOT": 2.0}
"""rad/s for one of theirs: deg/s, and a quaternion's derivative, which is half as long."""
_RATES = {"NONE": 0, "": 0, "ANGVEL": 3, "Q_DOT": 4, "EULER_RATE": 3, "GYRO_BIAS": 3}


def attitude_of(message: Message) -> AttitudeCourse:
    """The attitudes of all ATT blocks, which are in one pair of frames. Raises ``InvalidInput``.

    Refused by name: other attitudes than quaternions, a NUMBER_STATES that is not that of the rows, files that stop
    before STOP_TIME.
    """
    meta: Block | None = None
    frames: tuple[str, str] | None = None
    epochs: list[int] = []
    turns: list[list[float]] = []
    pieces: list[int] = []
    left_out: list[str] = []
    for one in message.blocks():
        if one.name == "META":
            meta = one
        elif meta is None:
            raise refused(one.fields.line, "META_START before data", one.name or "data")
        elif one.name == "ATT":
            own = one.fields.get("REF_FRAME_A"), one.fields.get("REF_FRAME_B")
            if frames is not None and own != frames:
                raise refused(one.fields.line, "attitudes in one pair of frames", own)
            frames = own
            if not one.rows:
                raise refused(one.fields.line, "attitudes in ATT", "none (truncated)")
            own_epochs = times_of(meta, one.rows)
            pieces.append(len(epochs))
            epochs += own_epochs
            turns += _turns(one, own_epochs)
            left_out += ["rates"] if one.rows and len(one.rows[0].value.split()) > 5 else []
        elif one.name in _OTHERS:
            left_out.append(f"block {one.name}")
        else:
            raise refused(one.fields.line, f"a block of ACM: ATT, {', '.join(_OTHERS)}", one.name or "data")
    if meta is None or frames is None:
        raise invalid("file", "attitudes (ATT_START)", "none (truncated)")
    if meta.fields.has("STOP_TIME"):
        stop = times_of(meta, [meta.fields.values["STOP_TIME"]])[0]
        if epochs[-1] < stop:
            raise refused(
                meta.fields.line,
                f"attitudes up to STOP_TIME {meta.fields.get('STOP_TIME')}",
                "fewer (truncated)",
            )
    designator = meta.fields.get("INTERNATIONAL_DESIGNATOR", meta.fields.get("OBJECT_DESIGNATOR", "UNKNOWN"))
    return AttitudeCourse(
        meta.fields.get("OBJECT_NAME"),
        designator,
        *frames,
        meta.fields.get("TIME_SYSTEM"),
        np.array(epochs, dtype=np.int64),
        np.array(turns),
        tuple(pieces),
        left_out=tuple(dict.fromkeys(left_out)),
    )


def _turns(one: Block, epochs: list[int]) -> list[list[float]]:
    """Quaternions of the rows, scalar first."""
    kind, rate = one.fields.get("ATT_TYPE").upper(), one.fields.get("RATE_TYPE", "").upper()
    if kind != "QUATERNION":
        raise refused(one.fields.line, "ATT_TYPE QUATERNION", kind)
    if rate not in _RATES:
        raise refused(one.fields.line, f"RATE_TYPE {', '.join(filter(None, _RATES))}", rate)
    width, states = 4 + _RATES[rate], one.fields.get("NUMBER_STATES")
    if states != str(width):
        raise refused(one.fields.line, f"NUMBER_STATES {width} of quaternion and {rate or 'no rate'}", states)
    one.fields.done(_ATT)
    turns, rates = [], []
    for row in one.rows:
        _, *values = row.value.split()
        if len(values) != width:
            raise refused(row.line, f"a time and {width} numbers", f"{len(values)} numbers")
        x, y, z, scalar = (number(text, row.line, "quaternion") for text in values[:4])
        turns.append([scalar, x, y, z])
        rates.append(math.hypot(*(number(text, row.line, rate) for text in values[4:])))
    if rate in _UNITS:
        require_dense(np.array(epochs), _UNITS[rate] * np.array(rates))
    return turns

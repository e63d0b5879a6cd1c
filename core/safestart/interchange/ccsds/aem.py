"""Attitude Ephemeris Messages (504.0-B-1, 504.0-B-2) as :class:`AttitudeCourse`, and back: quaternions."""

from __future__ import annotations

import math

import numpy as np

from safestart.errors import invalid
from safestart.interchange.attitude_course import AttitudeCourse, require_dense, turns_of
from safestart.interchange.ccsds.message import Block, Message, block, header_of, key
from safestart.interchange.ccsds.tokens import Kind, Token, decimal, number, refused
from safestart.interchange.ccsds.useable import useable_keys, useable_of
from safestart.interchange.epochs import epochs_of, shortened, text_of

_SAME_ATTITUDE = 1e-3
"""rad"""
TYPES = {"QUATERNION": 4, "QUATERNION/DERIVATIVE": 8, "QUATERNION/RATE": 7, "QUATERNION/ANGVEL": 7}
"""Supported attitude types, and the numbers in a row; rates after the quaternion say whether it is dense enough."""
_META = (
    *("OBJECT_NAME", "OBJECT_ID", "CENTER_NAME", "REF_FRAME_A", "REF_FRAME_B", "ATTITUDE_DIR", "TIME_SYSTEM"),
    *(
        "START_TIME",
        "STOP_TIME",
        "USEABLE_START_TIME",
        "USEABLE_STOP_TIME",
        "ATTITUDE_TYPE",
        "QUATERNION_TYPE",
    ),
    *("RATE_FRAME", "ANGVEL_FRAME", "EULER_ROT_SEQ", "INTERPOLATION_METHOD", "INTERPOLATION_DEGREE"),
)
_SAME = ("OBJECT_NAME", "OBJECT_ID", "REF_FRAME_A", "REF_FRAME_B", "TIME_SYSTEM")


def attitude_of(message: Message) -> AttitudeCourse:
    """The attitudes of all segments, which are of one body against one frame. Raises ``InvalidInput``."""
    meta: Block | None = None
    same: dict[str, str] = {}
    texts: list[str] = []
    turns: list[list[float]] = []
    pieces: list[int] = []
    useable: list[tuple[int, int] | None] = []
    for one in message.blocks():
        if one.name == "META":
            given = {name: one.fields.get(name) for name in _SAME}
            one.fields.done(_META)
            if same and given != same:
                raise refused(one.fields.line, "segments of one body in one pair of frames", given)
            meta, same = one, given
        elif meta is None or one.name not in ("DATA", ""):
            raise refused(one.fields.line, "META_START, then DATA_START", one.name or "data")
        else:
            one.fields.done()
            own_texts, own_turns = _rows(meta, one, same["TIME_SYSTEM"])
            if not own_texts:
                raise refused(one.fields.line, "attitudes in every segment", "none (truncated)")
            if _goes_on(one, texts, turns, own_texts, own_turns, same["TIME_SYSTEM"]):
                # Both segments hold the attitude at which they meet.
                del own_texts[0], own_turns[0]
            pieces.append(len(texts))
            useable.append(useable_of(meta, same["TIME_SYSTEM"]))
            texts += own_texts
            turns += own_turns
            stop = meta.fields.get("STOP_TIME")
            ends = epochs_of([texts[-1], stop], same["TIME_SYSTEM"]).tolist()
            if ends[0] < ends[1]:
                raise refused(
                    one.fields.line,
                    f"attitudes up to STOP_TIME {stop}",
                    f"the last at {texts[-1]} (truncated)",
                )
    if not texts:
        raise invalid("file", "attitudes", "none (truncated)")
    return AttitudeCourse(
        same["OBJECT_NAME"],
        same["OBJECT_ID"],
        same["REF_FRAME_A"],
        same["REF_FRAME_B"],
        same["TIME_SYSTEM"],
        epochs_of(texts, same["TIME_SYSTEM"]),
        np.array(turns),
        tuple(pieces),
        tuple(useable) if any(useable) else (),
        ("rates",) if meta is not None and TYPES[meta.fields.get("ATTITUDE_TYPE").upper()] > 4 else (),
    )


def _goes_on(
    one: Block,
    texts: list[str],
    turns: list[list[float]],
    own_texts: list[str],
    own_turns: list[list[float]],
    system: str,
) -> bool:
    """Whether a segment begins where the last one ends; refuses a body that jumps there."""
    if not texts or len(own_texts) < 2:
        return False
    before, begin = epochs_of([texts[-1], own_texts[0]], system).tolist()
    if before != begin:
        return False
    if float(turns_of(np.array([turns[-1], own_turns[0]]))[0]) > _SAME_ATTITUDE:
        raise refused(one.fields.line, f"one attitude at {own_texts[0]}, where two segments meet", "two")
    return True


def _rows(meta: Block, one: Block, system: str) -> tuple[list[str], list[list[float]]]:
    """Epochs and quaternions, scalar first, reference to body."""
    kind = meta.fields.get("ATTITUDE_TYPE").upper()
    if kind not in TYPES:
        raise refused(meta.fields.line, f"ATTITUDE_TYPE {' or '.join(TYPES)}", kind)
    order = meta.fields.get("QUATERNION_TYPE", "LAST").upper()
    direction = meta.fields.get("ATTITUDE_DIR", "A2B").upper()
    if order not in ("FIRST", "LAST") or direction not in ("A2B", "B2A"):
        raise refused(
            meta.fields.line, "QUATERNION_TYPE FIRST or LAST, ATTITUDE_DIR A2B or B2A", (order, direction)
        )
    texts, turns, rates = [], [], []
    for row in one.rows:
        epoch, *values = row.value.split()
        # XML has only the quaternion.
        if len(values) not in (4, TYPES[kind]):
            raise refused(row.line, f"an epoch and {TYPES[kind]} numbers", f"{len(values)} numbers")
        numbers = [number(text, row.line, "quaternion") for text in values]
        turn = numbers[:4] if order == "FIRST" else [numbers[3], *numbers[:3]]
        turns.append(turn if direction == "A2B" else [turn[0], *(-value for value in turn[1:])])
        texts.append(epoch)
        if len(numbers) > 4:
            rates.append(math.hypot(*numbers[4:]))
    if len(rates) == len(turns) > 0:
        # Derivatives of a quaternion are half as long as the rate; the other rates are deg/s.
        unit = 2.0 if kind == "QUATERNION/DERIVATIVE" else math.radians(1.0)
        require_dense(epochs_of(texts, system), unit * np.array(rates))
    return texts, turns


def tokens_of(course: AttitudeCourse, created: str, originator: str = "SAFESTART") -> list[Token]:
    """An AEM 2.0 of the course, A to B, scalar last; every number reads back as the same double."""
    out = header_of("AEM", "2.0", created, originator)
    texts = [shortened(text) for text in text_of(course.epochs, course.time_system)]
    meta = {
        "OBJECT_NAME": course.name,
        "OBJECT_ID": course.object_id,
        "REF_FRAME_A": course.reference,
        "REF_FRAME_B": course.body,
        "TIME_SYSTEM": course.time_system,
    }
    rows = [
        Token(Kind.ROW, value=" ".join([epoch, *(decimal(value) for value in (*turn[1:], turn[0]))]))
        for epoch, turn in zip(texts, course.quaternions.tolist(), strict=True)
    ]
    ends = [*course.pieces[1:], len(rows)]
    for k, (begin, end) in enumerate(zip(course.pieces, ends, strict=True)):
        own = {"START_TIME": texts[begin], "STOP_TIME": texts[end - 1]}
        own |= useable_keys(course.useable[k] if course.useable else None, course.time_system)
        whole = meta | own | {"ATTITUDE_TYPE": "QUATERNION"}
        out += block("META", [key(*pair) for pair in whole.items()])
        out += block("DATA", rows[begin:end])
    return out

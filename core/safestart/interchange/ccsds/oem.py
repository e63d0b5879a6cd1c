"""Orbit Ephemeris Messages (502.0-B-3) as :class:`Ephemeris`, and back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from safestart.errors import invalid
from safestart.interchange.attitude_course import Window
from safestart.interchange.ccsds.message import Block, Message, block, header_of, key
from safestart.interchange.ccsds.tokens import Kind, Token, decimal, number, refused
from safestart.interchange.ccsds.useable import useable_keys, useable_of
from safestart.interchange.covariance import Covariance, Sense, covariance_frame
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import epochs_of, shortened, text_of

_META = (
    *("OBJECT_NAME", "OBJECT_ID", "CENTER_NAME", "REF_FRAME", "REF_FRAME_EPOCH", "TIME_SYSTEM", "START_TIME"),
    *("STOP_TIME", "USEABLE_START_TIME", "USEABLE_STOP_TIME", "INTERPOLATION", "INTERPOLATION_DEGREE"),
)
_SAME = ("OBJECT_NAME", "OBJECT_ID", "CENTER_NAME", "REF_FRAME", "TIME_SYSTEM")


def ephemeris_of(message: Message, sense: Sense | None = None) -> Ephemeris:
    """The states of all segments, which are of one object in one frame; each begins a piece.

    ``sense`` is for covariances in RTN or RSW (:func:`covariance_frame`). Raises ``InvalidInput``.
    """
    meta: Block | None = None
    same: dict[str, str] = {}
    pieces: list[int] = []
    texts: list[str] = []
    states: list[list[float]] = []
    covariances: list[Covariance] = []
    useable: list[Window | None] = []
    accelerations = False
    for one in message.blocks():
        if one.name == "META":
            meta, given = one, _same(one)
            one.fields.done(_META)
            if same and given != same:
                raise refused(one.fields.line, "segments of one object in one frame and time system", given)
            same = given
            pieces.append(len(texts))
            useable.append(useable_of(one, same["TIME_SYSTEM"]))
        elif meta is None:
            raise refused(one.fields.line, "META_START before data", one.name or "data")
        elif one.name == "COVARIANCE":
            covariances.append(_covariance(one, same, sense))
        elif one.name:
            raise refused(one.fields.line, "a block META or COVARIANCE", one.name)
        else:
            one.fields.done()
            for row in one.rows:
                epoch, *values = row.value.split()
                if len(values) not in (6, 9):
                    raise refused(
                        row.line, "an epoch and 6 numbers, or 9 with acceleration", f"{len(values)} numbers"
                    )
                accelerations = accelerations or len(values) == 9
                texts.append(epoch)
                states.append([number(text, row.line, "state", 3) for text in values[:6]])
            _within(meta, texts[pieces[-1] :], same["TIME_SYSTEM"])
    if not texts:
        raise invalid("file", "states", "none (truncated)")
    if pieces[-1] == len(texts):
        raise invalid("file", "states in every segment", "a segment without (truncated)")
    return Ephemeris(
        same["OBJECT_NAME"],
        same["OBJECT_ID"],
        same["REF_FRAME"],
        same["TIME_SYSTEM"],
        epochs_of(texts, same["TIME_SYSTEM"]),
        np.array(states),
        tuple(covariances),
        tuple(pieces),
        same["CENTER_NAME"],
        tuple(useable) if any(useable) else (),
        ("accelerations",) if accelerations else (),
    )


def _same(meta: Block) -> dict[str, str]:
    return {name: meta.fields.get(name) for name in _SAME}


def _within(meta: Block, texts: Sequence[str], system: str) -> None:
    """Raise ``InvalidInput`` if states end before STOP_TIME or lie outside (truncated, mislabelled)."""
    start, stop = meta.fields.get("START_TIME"), meta.fields.get("STOP_TIME")
    first, last, begin, end = epochs_of([start, stop, texts[0], texts[-1]], system).tolist()
    if not first <= begin <= end <= last:
        raise refused(meta.fields.line, f"states within {start} .. {stop}", f"{texts[0]} .. {texts[-1]}")
    if end < last:
        raise refused(
            meta.fields.line, f"states up to STOP_TIME {stop}", f"the last at {texts[-1]} (truncated)"
        )


def _covariance(one: Block, same: dict[str, str], sense: Sense | None) -> Covariance:
    """The matrix of a block: EPOCH, the frame if it is another, six rows of the lower triangle."""
    frame = one.fields.get("COV_REF_FRAME", same["REF_FRAME"])
    epoch = one.fields.get("EPOCH")
    one.fields.done()
    if len(one.rows) != 6:
        raise refused(one.fields.line, "six rows of a covariance", len(one.rows))
    matrix = triangle([row.value.split() for row in one.rows], one.fields.line)
    return Covariance(int(epochs_of([epoch], same["TIME_SYSTEM"])[0]), covariance_frame(frame, sense), matrix)


def triangle(
    rows: Sequence[Sequence[str]], line: int, power: int = 6
) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """The symmetric matrix (6, 6) of the rows of its lower triangle, each times 10^power."""
    matrix = np.zeros((6, 6))
    for k, row in enumerate(rows):
        if len(row) != k + 1:
            raise refused(line, f"{k + 1} numbers in row {k + 1} of a covariance", len(row))
        for j, text in enumerate(row):
            matrix[k, j] = matrix[j, k] = number(text, line, "covariance", power)
    return matrix


def tokens_of(ephemeris: Ephemeris, created: str, originator: str = "SAFESTART") -> list[Token]:
    """An OEM 3.0 of the course; every number reads back as the same double."""
    out = header_of("OEM", "3.0", created, originator)
    system = ephemeris.time_system
    texts = [shortened(text) for text in text_of(ephemeris.epochs, system)]
    rows = [
        Token(Kind.ROW, value=" ".join([epoch, *(decimal(value, 3) for value in state)]))
        for epoch, state in zip(texts, ephemeris.states.tolist(), strict=True)
    ]
    ends = [*ephemeris.pieces[1:], len(rows)]
    for k, (begin, end) in enumerate(zip(ephemeris.pieces, ends, strict=True)):
        window = ephemeris.useable[k] if ephemeris.useable else None
        meta = {
            "OBJECT_NAME": ephemeris.name,
            "OBJECT_ID": ephemeris.object_id,
            "CENTER_NAME": ephemeris.center,
            "REF_FRAME": ephemeris.frame,
            "TIME_SYSTEM": system,
            "START_TIME": texts[begin],
            **useable_keys(window, system),
            "STOP_TIME": texts[end - 1],
        }
        out += block("META", [key(*pair) for pair in meta.items()])
        out += rows[begin:end]
    if ephemeris.covariances:
        for one in ephemeris.covariances:
            out += block("COVARIANCE", _written(one, system))
    return out


def _written(one: Covariance, system: str) -> list[Token]:
    epoch = shortened(text_of(np.array([one.epoch]), system)[0])
    out = [key("EPOCH", epoch), key("COV_REF_FRAME", one.frame.replace("RTN", "RSW"))]
    for k, row in enumerate(one.matrix.tolist()):
        out.append(Token(Kind.ROW, value=" ".join(decimal(value, 6) for value in row[: k + 1])))
    return out

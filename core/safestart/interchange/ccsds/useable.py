"""The useable span of a segment: what lies outside it only helps to interpolate (502.0-B-3, 504.0-B-2)."""

from __future__ import annotations

import numpy as np

from safestart.interchange.attitude_course import Window
from safestart.interchange.ccsds.message import Block
from safestart.interchange.ccsds.tokens import refused
from safestart.interchange.epochs import epochs_of, shortened, text_of

_NAMES = ("USEABLE_START_TIME", "USEABLE_STOP_TIME")
_EVER = 2**62


def useable_of(one: Block, system: str) -> Window | None:
    """First and last useable epoch, TAI, of a block; None where it names neither. Raises ``InvalidInput``."""
    begin, end = (
        int(epochs_of([one.fields.get(name)], system)[0]) if one.fields.has(name) else None for name in _NAMES
    )
    return window_of(begin, end, one.fields.line)


def window_of(begin: int | None, end: int | None, line: int) -> Window | None:
    """The window of two epochs, either of which may be open; raises ``InvalidInput`` for an end before the begin."""
    if begin is None and end is None:
        return None
    found = (-_EVER if begin is None else begin, _EVER if end is None else end)
    if found[1] < found[0]:
        raise refused(line, "USEABLE_STOP_TIME after USEABLE_START_TIME", "one before it")
    return found


def useable_keys(window: Window | None, system: str) -> dict[str, str]:
    """The keywords that :func:`useable_of` reads."""
    return {
        name: shortened(text_of(np.array([at]), system)[0])
        for name, at in zip(_NAMES, window or (), strict=False)
        if abs(at) < _EVER
    }

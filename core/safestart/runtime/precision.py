"""The precision of ball arithmetic is one number for the whole process, all threads together: one at a time sets it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import RLock

import flint

_LOCK = RLock()


@contextmanager
def precise(bits: int) -> Iterator[None]:
    """Balls of so many bits inside; what was set before, afterwards.

    Another user of the library could still change it meanwhile: balls stay sound then, only wider, and what is too wide
    is refused where it is used.
    """
    with _LOCK:
        before = flint.ctx.prec
        flint.ctx.prec = bits
        try:
            yield
        finally:
            flint.ctx.prec = before

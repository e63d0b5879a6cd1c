"""The precision of ball arithmetic is one number for all threads of the process, so one thread at a time sets it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import flint

from safestart.runtime.children.forks import ForkableLock

_LOCK = ForkableLock()


@contextmanager
def precise(bits: int) -> Iterator[None]:
    """Use this many bits inside the block, and restore the earlier precision afterwards.

    Other users of the library could still change it meanwhile. Balls then stay sound but get wider, and the code
    that uses them refuses balls that are too wide.
    """
    with _LOCK:
        before = flint.ctx.prec
        flint.ctx.prec = bits
        try:
            yield
        finally:
            flint.ctx.prec = before

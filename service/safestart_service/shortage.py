"""A machine without room for an answer: no thread, no memory, no file. It is no fault of ours, and may pass.

Any line of any route can meet it, so the outermost layer asks here about every error that nothing else explains.
"""

from __future__ import annotations

import errno

from safestart.errors import Unavailable

_OF_SYSTEM = frozenset(
    {
        errno.ENOMEM,
        errno.EAGAIN,
        errno.EMFILE,
        errno.ENFILE,
        errno.ENOSPC,
        getattr(errno, "EDQUOT", errno.ENOSPC),
    }
)
_OF_THREADS = (
    "can't start new thread",
    "can't allocate lock",
    "cannot schedule new futures after",  # the service stops
    "can't create new thread at interpreter shutdown",
)
"""Python has no type of its own for these."""
_OF_LIBRARIES = ("failed to map segment", "cannot allocate memory", "cannot map", "too many open files")
"""What the loader says of a library that does not fit; the C library's words, not in the user's language."""


def shortage(error: BaseException) -> Unavailable | None:
    """The refusal, if the machine had no room: of this error, of its cause, or of all errors of a group."""
    reason = _reason(error)
    if reason is None:
        return None
    required = "the same request later"
    return Unavailable(
        f"this machine has no room for the answer ({reason}); required {required}", required=required
    )


def _reason(error: BaseException | None) -> str | None:
    if isinstance(error, MemoryError):
        return "no memory"
    if isinstance(error, OSError) and error.errno in _OF_SYSTEM:
        return error.strerror or "no room"  # never str(error): it may name a file
    if isinstance(error, RuntimeError) and any(words in str(error) for words in _OF_THREADS):
        return str(error)
    if isinstance(error, ImportError | OSError) and any(
        words in str(error).lower() for words in _OF_LIBRARIES
    ):
        return "no memory to load a library"
    if isinstance(error, BaseExceptionGroup):
        reasons = [_reason(one) for one in error.exceptions]
        return reasons[0] if all(reasons) else None
    return None if error is None else _reason(error.__cause__)

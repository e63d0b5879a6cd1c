"""What glibc's allocator keeps of freed memory; elsewhere nothing happens here."""

from __future__ import annotations

import ctypes
from contextlib import suppress

_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3

MEGABYTE = 1024**2


def keep_little(most: int = 4 * MEGABYTE) -> None:
    """Give blocks of more bytes than ``most`` back when they are freed, in this process and those that it forks.

    A block that comes from the system costs a page fault for every 4 KiB, so answers of usual size stay below.
    Left alone, glibc raises its threshold with the first large block that is freed: from then on bodies and answers of
    megabytes lie on the heap, which stays as large as it ever was.
    """
    with suppress(OSError, AttributeError):
        libc = ctypes.CDLL(None)
        libc.mallopt(_M_MMAP_THRESHOLD, most)
        libc.mallopt(_M_TRIM_THRESHOLD, most)


def return_freed() -> None:
    """Give back what was freed in small blocks."""
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None).malloc_trim(0)

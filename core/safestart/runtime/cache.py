"""What was computed before, found by the content of the question: a cache that may forget, never a record."""

from __future__ import annotations

from typing import Protocol


class Shelf(Protocol):
    """Bytes by content key; losing them costs time and nothing else."""

    def find(self, key: str) -> bytes | None:
        """The bytes kept under ``key``, None when there are none (or the place they are kept is away)."""

    def keep(self, key: str, data: bytes) -> None:
        """Keep ``data`` under ``key``; may be declined silently."""


class _Empty:
    def find(self, key: str) -> bytes | None:  # noqa: ARG002
        return None

    def keep(self, key: str, data: bytes) -> None:
        """Decline."""


EMPTY: Shelf = _Empty()
"""Holds nothing."""

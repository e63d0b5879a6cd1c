"""A cache of earlier answers, keyed by the content of the question. It may forget; it is not a record."""

from __future__ import annotations

from typing import Protocol


class Shelf(Protocol):
    """Bytes by content key; losing them costs only time."""

    def find(self, key: str) -> bytes | None:
        """The bytes stored under ``key``; None when there are none or the storage is unavailable."""

    def keep(self, key: str, data: bytes) -> None:
        """Store ``data`` under ``key``; the cache may silently decline."""


class _Empty:
    def find(self, key: str) -> bytes | None:  # noqa: ARG002
        return None

    def keep(self, key: str, data: bytes) -> None:
        """Decline."""


EMPTY: Shelf = _Empty()
"""Holds nothing."""

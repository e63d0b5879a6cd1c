"""The result of one shard of a campaign."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Part:
    """A small JSON-able document, and bytes that only the merge reads."""

    document: dict[str, Any]
    data: bytes = b""

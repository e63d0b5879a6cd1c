"""A file that belongs to a result; processes make artifacts and the store keeps them."""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import sha256


@dataclass(frozen=True, slots=True)
class Artifact:
    """A file that belongs to a result: name, IANA media type, bytes.

    ``key``, when given, is a content key under which later answers may find the bytes (see ``shelf``).
    """

    name: str
    media_type: str
    data: bytes
    key: str | None = None

    @property
    def sha256(self) -> str:
        """Hex digest of the bytes."""
        return sha256(self.data).hexdigest()

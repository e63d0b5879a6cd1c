"""Who may do what: roles, callers, and the form of an API key.

A key is ``sst_ID_SECRET``: the public id names it in lists and logs, the secret is 256 random bits. The store keeps
the SHA-256 of the whole key. A slow password hash protects secrets that people choose; nobody guesses 256 random
bits, and the slow hash would delay every request.
"""

from __future__ import annotations

import secrets
from dataclasses import dataclass
from enum import StrEnum
from hashlib import sha256

PREFIX = "sst"


class Role(StrEnum):
    """What a key allows; each role includes those before it."""

    READ = "read"
    SUBMIT = "submit"
    ADMIN = "admin"

    def allows(self, needed: Role) -> bool:
        """True when this role includes the role ``needed``."""
        return _RANK[self] >= _RANK[needed]


_RANK = {role: rank for rank, role in enumerate(Role)}


@dataclass(frozen=True, slots=True)
class Caller:
    """The caller, as the audit log names it.

    Without a key ``key_id`` is None and ``name`` says where the request came from (``local``, ``cli``).
    """

    key_id: str | None
    name: str
    role: Role
    address: str | None = None
    request_id: str | None = None


LOCAL = Caller(None, "local", Role.SUBMIT)
"""A caller without a key, on a service that requires none. Administration always requires a key."""


def new_key() -> tuple[str, str]:
    """Make a key; returns its id and the whole key, which is shown once and never stored."""
    key_id = secrets.token_hex(6)
    return key_id, f"{PREFIX}_{key_id}_{secrets.token_urlsafe(32)}"


def key_digest(key: bytes) -> bytes:
    """The 32 bytes that are stored of a key."""
    return sha256(key).digest()

"""Who may do what: roles, callers, and the form of an API key.

A key is ``sst_ID_SECRET``: the public id names it in lists and logs, the secret is 256 random bits. What is kept is the
SHA-256 of the whole key. A slow password hash would add nothing: it makes guessing dear where secrets are chosen by
people, and nobody guesses 256 bits; and it would cost every request what it costs a guess.
"""

from __future__ import annotations

import re
import secrets
from dataclasses import dataclass
from enum import StrEnum
from hashlib import sha256

PREFIX = "sst"
KEY_PATTERN = re.compile(r"sst_([0-9a-f]{12})_[A-Za-z0-9_-]{43}")


class Role(StrEnum):
    """What a key allows; each role includes those before it."""

    READ = "read"
    SUBMIT = "submit"
    ADMIN = "admin"

    def allows(self, needed: Role) -> bool:
        """True when this role is enough for what needs ``needed``."""
        return _RANK[self] >= _RANK[needed]


_RANK = {role: rank for rank, role in enumerate(Role)}


@dataclass(frozen=True, slots=True)
class Caller:
    """Who asks, as the audit log names them.

    ``key_id`` is None without a key: then ``name`` says where the request came from (``local``, ``cli``).
    """

    key_id: str | None
    name: str
    role: Role
    address: str | None = None
    request_id: str | None = None


LOCAL = Caller(None, "local", Role.SUBMIT)
"""A caller without a key, on a service that asks for none. Administration asks for a key always."""


def new_key() -> tuple[str, str]:
    """A fresh key: its id and the whole key, which is shown once and not kept."""
    key_id = secrets.token_hex(6)
    return key_id, f"{PREFIX}_{key_id}_{secrets.token_urlsafe(32)}"


def key_digest(key: bytes) -> bytes:
    """What is kept of a key: 32 bytes."""
    return sha256(key).digest()

"""The keys in memory, read again twice a second, so that checking a key needs no database.

A key made, revoked or expired elsewhere takes effect here at most that much later; a key revoked through this
service, at once. While the database is unavailable, the last read keys stay valid.
"""

from __future__ import annotations

import asyncio
import logging
import secrets
from collections.abc import AsyncIterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import asynccontextmanager
from hmac import compare_digest
from time import monotonic
from typing import TYPE_CHECKING

from safestart.errors import SafestartError
from safestart.runtime.access import key_digest
from safestart_service.shortage import shortage

if TYPE_CHECKING:
    from safestart.store.access.keys import KeyRepository
    from safestart.store.records import ApiKey

REFRESH_S = 0.5
# Record the last use of a key about once a minute: a busy key must not write with every request.
NOTE_S = 60.0

log = logging.getLogger("safestart.service")


class Keyring:
    """Digests and records of all keys.

    ``known`` is False until the first read, ``begun`` until somebody reads at all. ``required``: a key was made at some
    time, so callers need one, even if no key is in force now.
    """

    def __init__(self, keys: KeyRepository) -> None:
        self._keys = keys
        self._held: dict[bytes, tuple[ApiKey | None, bytes]] = {}
        self._decoy: tuple[ApiKey | None, bytes] = (None, secrets.token_bytes(32))
        self._in_force: frozenset[str] = frozenset()
        self._used: set[str] = set()
        self._noted: dict[str, float] = {}
        self.begun = self.known = False
        self.required = False

    def check(self, presented: bytes) -> ApiKey | None:
        """The key's record, if the key exists and is in force.

        Every presented text takes the same steps: a digest, a look-up by the digest, and a comparison in constant
        time, with a decoy when nothing was found. The look-up time depends on the digest, which says nothing about
        the key. Only a caller with the whole key reaches the check whether it is in force.
        """
        digest = key_digest(presented)
        key, kept = self._held.get(digest, self._decoy)
        if not compare_digest(digest, kept) or key is None or not key.usable:
            return None
        self._used.add(key.id)
        return key

    def in_force(self, key_id: str) -> bool:
        """True while the key of this id is neither revoked nor expired."""
        return key_id in self._in_force

    def load(self) -> None:
        """Read the keys, and record which were used; raises ``Unavailable``."""
        held: dict[bytes, tuple[ApiKey | None, bytes]] = {
            digest: (key, digest) for key, digest in self._keys.digests()
        }
        self._held, self.required, self.known = held, bool(held), True
        self._in_force = frozenset(key.id for key, _ in held.values() if key is not None and key.usable)
        now = monotonic()
        due = [key_id for key_id in list(self._used) if now - self._noted.get(key_id, -NOTE_S) >= NOTE_S]
        if due:
            self._keys.used(due)
            self._used.difference_update(due)
            self._noted.update(dict.fromkeys(due, now))

    @asynccontextmanager
    async def kept_fresh(self) -> AsyncIterator[None]:
        """Read the keys now and repeatedly until the end."""
        # In its own thread, so that a key revoked elsewhere is refused in time even under heavy computing.
        self.begun = True
        reader = ThreadPoolExecutor(1, "keyring")
        await self._try_load(reader)
        task = asyncio.create_task(self._keep(reader))
        try:
            yield
        finally:
            task.cancel()
            reader.shutdown(wait=False)

    async def _keep(self, reader: Executor) -> None:
        while True:
            await asyncio.sleep(REFRESH_S)
            await self._try_load(reader)

    async def _try_load(self, reader: Executor) -> None:
        try:
            await asyncio.get_running_loop().run_in_executor(reader, self.load)
        except SafestartError as error:
            log.warning("keys not read: %s", error.detail)
        except Exception as error:  # else nobody would read them again, and an ended key would pass for ever
            no_room = shortage(error)
            if no_room is None:
                log.exception("keys not read")
            else:
                log.warning("keys not read: %s", no_room.detail)

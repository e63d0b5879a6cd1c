"""Cache by content key beside the record of work: bounded, drops the oldest first, and never blocks an answer."""

from __future__ import annotations

import logging
from hashlib import sha256

from sqlalchemy import delete, func, insert, select
from sqlalchemy.orm import Session

from safestart.errors import Unavailable
from safestart.store.database import Database
from safestart.store.models import CacheRow

MOST_BYTES = 256 * 1024 * 1024
MOST_BYTES_EACH = 16 * 1024 * 1024

log = logging.getLogger("safestart.store")


class Cache:
    """A :class:`safestart.runtime.cache.Shelf` over the database; during an outage it finds and stores nothing."""

    def __init__(self, database: Database, most_bytes: int = MOST_BYTES) -> None:
        self._database, self._most = database, most_bytes

    def find(self, key: str) -> bytes | None:
        """The bytes stored under ``key``; None when there are none or they were altered."""
        try:
            with self._database.session() as session:
                row = session.execute(
                    select(CacheRow.data, CacheRow.sha256).where(CacheRow.key == key)
                ).one_or_none()
        except Unavailable as error:
            log.warning("cache not read: %s", error.detail)
            return None
        if row is None or sha256(row.data).hexdigest() != row.sha256:
            return None
        return bytes(row.data)

    def keep(self, key: str, data: bytes) -> None:
        """Store ``data`` under ``key``, replacing earlier data."""
        try:
            with self._database.session(write=True) as session:
                shelve(session, key, data, self._most)
        except Unavailable as error:
            log.warning("cache not written: %s", error.detail)


def shelve(session: Session, key: str, data: bytes, most_bytes: int = MOST_BYTES) -> None:
    """Store ``data`` under ``key`` in this transaction, and drop the oldest entries beyond ``most_bytes`` in total."""
    if len(data) > min(MOST_BYTES_EACH, most_bytes):
        return
    session.execute(delete(CacheRow).where(CacheRow.key == key))
    values = {"key": key, "sha256": sha256(data).hexdigest(), "size": len(data), "data": data}
    session.execute(insert(CacheRow).values(values))
    total = func.sum(CacheRow.size).over(order_by=CacheRow.seq.desc())
    sums = select(CacheRow.seq, total.label("total")).subquery()
    session.execute(
        delete(CacheRow).where(CacheRow.seq.in_(select(sums.c.seq).where(sums.c.total > most_bytes)))
    )

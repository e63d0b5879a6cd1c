"""Make, list and revoke API keys; the store keeps only their digests."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from sqlalchemy import ColumnElement, and_, or_, select, update

from safestart.errors import NotFound, invalid
from safestart.runtime.access import Caller, Role, key_digest, new_key
from safestart.store.access.audit import add_audit
from safestart.store.access.models import KeyRow
from safestart.store.database import Database
from safestart.store.dialect import after
from safestart.store.records import ApiKey

MAX_NAME = 100
MAX_DAYS = 3660.0
_DAY_S = 86_400.0
Show = Callable[[ApiKey, str], None]


class KeyRepository:
    """All operations on keys; safe to share between threads."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def create(
        self, name: str, role: Role, days: float | None, by: Caller, show: Show | None = None
    ) -> tuple[ApiKey, str]:
        """Make a key that expires after ``days`` (None: never); returns its record and the key itself, which cannot
        be read again.

        ``show`` gets both before the key is in force: what it raises leaves no key behind, as one that nobody has seen
        would close an open service for good. Writers wait for it, so it must not wait for anybody.
        Raises ``InvalidInput`` for a name that is empty or longer than 100 characters and for days not in (0,
        3660].
        """
        if not 1 <= len(name) <= MAX_NAME or not name.isprintable():
            raise invalid("name", f"1 to {MAX_NAME} printable characters", name)
        if days is not None and not 0 < days <= MAX_DAYS:
            raise invalid("days", f"a number in (0, {MAX_DAYS:g}]", days)
        key_id, key = new_key()
        with self._database.session(write=True) as session:
            row = KeyRow(
                id=key_id,
                name=name,
                role=Role(role).value,
                digest=key_digest(key.encode()),
                created_at=after(),
                expires_at=None if days is None else after(days * _DAY_S),
            )
            session.add(row)
            session.flush()
            add_audit(session, by, "create-key", key_id, {"name": name, "role": row.role, "days": days})
            session.refresh(row)
            record = row.record(True)
            if show is not None:
                show(record, key)
            return record, key

    def list(self) -> tuple[ApiKey, ...]:
        """All keys ever made, oldest first."""
        return tuple(key for key, _ in self.digests())

    def digests(self) -> tuple[tuple[ApiKey, bytes], ...]:
        """All keys with their digests, for the check of presented keys."""
        query = select(KeyRow, _usable()).order_by(KeyRow.created_at, KeyRow.id)
        with self._database.session() as session:
            return tuple(
                (row.record(bool(usable)), bytes(row.digest)) for row, usable in session.execute(query)
            )

    def revoke(self, key_id: str, by: Caller) -> ApiKey:
        """End a key for good; revoking it again changes nothing. Raises ``NotFound``."""
        change = (
            update(KeyRow)
            .where(KeyRow.id == key_id, KeyRow.revoked_at.is_(None))
            .values(revoked_at=after())
            .execution_options(synchronize_session=False)
        )
        with self._database.session(write=True) as session:
            if session.execute(change).rowcount:  # type: ignore[attr-defined]
                add_audit(session, by, "revoke-key", key_id)
            row = session.get(KeyRow, key_id)
            if row is None:
                raise NotFound(
                    f"no key {key_id!r}; `safestart keys list` shows them",
                    field="keyID",
                    required="the id of a key",
                    received=key_id,
                )
            return row.record(False)

    def used(self, key_ids: Iterable[str]) -> None:
        """Note that these keys were used just now."""
        change = update(KeyRow).where(KeyRow.id.in_(tuple(key_ids))).values(last_used_at=after())
        with self._database.session(write=True) as session:
            session.execute(change.execution_options(synchronize_session=False))


def _usable() -> ColumnElement[bool]:
    alive = or_(KeyRow.expires_at.is_(None), KeyRow.expires_at > after())
    return and_(KeyRow.revoked_at.is_(None), alive)

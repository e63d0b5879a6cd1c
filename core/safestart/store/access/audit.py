"""The audit log: each entry is written in the transaction of its action; readers get the newest first."""

from __future__ import annotations

from typing import Any

from sqlalchemy import insert, select
from sqlalchemy.orm import Session

from safestart.errors import invalid
from safestart.runtime.access import Caller
from safestart.store.access.models import AuditRow
from safestart.store.database import Database
from safestart.store.dialect import after
from safestart.store.models import table
from safestart.store.records import AuditPage

MAX_PAGE = 1000
_ADD = insert(table(AuditRow)).values(at=after()).inline()


def add_audit(
    session: Session, by: Caller, action: str, subject: str, detail: dict[str, Any] | None = None
) -> None:
    """Note in this transaction that ``by`` did ``action`` to ``subject`` (the id of a job or a key)."""
    values = {
        "action": action,
        "subject": subject,
        "key_id": by.key_id,
        "actor": by.name[:100],
        "address": None if by.address is None else by.address[:64],
        "request_id": by.request_id,
        "detail": detail,
    }
    session.execute(_ADD, values)


class AuditLog:
    """Reading side of the log."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def entries(
        self,
        *,
        subject: str | None = None,
        key_id: str | None = None,
        before: int | None = None,
        limit: int = 100,
    ) -> AuditPage:
        """Entries with ids below ``before``, newest first, about one subject or by one key (neither given: all)."""
        if not 1 <= limit <= MAX_PAGE:
            raise invalid("limit", f"an integer in [1, {MAX_PAGE}]", limit)
        query = select(AuditRow).order_by(AuditRow.id.desc()).limit(limit + 1)
        if before is not None:
            query = query.where(AuditRow.id < before)
        if subject is not None:
            query = query.where(AuditRow.subject == subject)
        if key_id is not None:
            query = query.where(AuditRow.key_id == key_id)
        with self._database.session() as session:
            rows = [row.record() for row in session.scalars(query)]
        more = len(rows) > limit
        rows = rows[:limit]
        return AuditPage(tuple(rows), rows[-1].id if more else None)

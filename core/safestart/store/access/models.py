"""The tables of access: keys by their digests, and the log of who did what."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from sqlalchemy import Index, LargeBinary, String
from sqlalchemy.orm import Mapped, mapped_column

from safestart.runtime.access import Role
from safestart.store.models import Base, Counter
from safestart.store.records import ApiKey, AuditEntry


class KeyRow(Base):
    """An API key. Rows are never deleted: an ended key still shows that keys are required, and whose it was."""

    __tablename__ = "api_keys"

    id: Mapped[str] = mapped_column(String(12), primary_key=True)
    name: Mapped[str] = mapped_column(String(100))
    role: Mapped[str] = mapped_column(String(16))
    digest: Mapped[bytes] = mapped_column(LargeBinary)
    created_at: Mapped[datetime]
    expires_at: Mapped[datetime | None]
    revoked_at: Mapped[datetime | None]
    last_used_at: Mapped[datetime | None]

    def record(self, usable: bool) -> ApiKey:
        """The frozen record of this row; the database decides ``usable`` from revocation and expiry."""
        return ApiKey(
            id=self.id,
            name=self.name,
            role=Role(self.role),
            created_at=self.created_at,
            expires_at=self.expires_at,
            revoked_at=self.revoked_at,
            last_used_at=self.last_used_at,
            usable=usable,
        )


class AuditRow(Base):
    """One action of a caller; written in the transaction of that action."""

    __tablename__ = "audit"

    id: Mapped[int] = mapped_column(Counter, primary_key=True, autoincrement=True)
    at: Mapped[datetime]
    action: Mapped[str] = mapped_column(String(32))
    subject: Mapped[str] = mapped_column(String(64))
    key_id: Mapped[str | None] = mapped_column(String(12))
    actor: Mapped[str] = mapped_column(String(100))
    address: Mapped[str | None] = mapped_column(String(64))
    request_id: Mapped[str | None] = mapped_column(String(64))
    detail: Mapped[dict[str, Any] | None]

    __table_args__ = (Index("ix_audit_subject", "subject"), {"sqlite_autoincrement": True})

    def record(self) -> AuditEntry:
        """The frozen record of this row."""
        return AuditEntry(
            id=self.id,
            at=self.at,
            action=self.action,
            subject=self.subject,
            key_id=self.key_id,
            actor=self.actor,
            address=self.address,
            request_id=self.request_id,
            detail=self.detail,
        )

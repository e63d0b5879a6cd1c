"""Name, tags and note of a job, and the text that a search finds it by."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from sqlalchemy import select

from safestart.records.labels import labels_of
from safestart.runtime.access import Caller
from safestart.store.access.audit import add_audit
from safestart.store.database import Database
from safestart.store.jobs.finding import find
from safestart.store.models import JobRow
from safestart.store.records import Job


class Labelling:
    """Writes labels."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def label(
        self,
        job_id: str,
        *,
        name: str | None = None,
        tags: Iterable[str] | None = None,
        note: str | None = None,
        by: Caller | None = None,
    ) -> Job:
        """Write the given ones of name, tags and note; the audit log records the caller ``by``.

        Raises ``NotFound``, and ``InvalidInput`` for labels beyond their bounds (:mod:`safestart.records.labels`).
        """
        told: dict[str, Any] = labels_of(name=name, tags=tags, note=note)
        with self._database.session(write=True) as session:
            # PostgreSQL: two who label the same job wait for each other, as the searched text is made of both labels.
            session.execute(select(JobRow.seq).where(JobRow.id == job_id).with_for_update())
            row = find(session, job_id)
            changed = [key for key, value in told.items() if getattr(row, key) != value]
            for key in changed:
                setattr(row, key, told[key])
            row.search = searched(row.id, row.process_id, row.name, row.tags)
            session.flush()
            if changed and by is not None:
                add_audit(session, by, "label", job_id, {"changed": changed})
            return row.record()


def searched(job_id: str, process_id: str, name: str, tags: Iterable[str]) -> str:
    """The text that a search looks through: small letters, a line for each part; tags begin with what no name has."""
    parts = (job_id, process_id, name, *(f"\t{tag}" for tag in tags))
    return "".join(f"\n{part}" for part in parts if part).lower() + "\n"


def of_tag(tag: str) -> str:
    """Give the text that a job with this tag holds, and no other job."""
    return f"\n\t{tag.lower()}\n"

"""Finished shards of a job: written under its lease, read to resume the job and to show its partial result."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sqlalchemy import delete, insert, select

from safestart.store.database import Database
from safestart.store.dialect import after
from safestart.store.models import ShardRow
from safestart.store.queue.holding import change
from safestart.store.records import Claim, Shard


class Shards:
    """Operations on the shards of jobs. A job's success deletes its shards, as its result replaces them."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def save_shards(self, claim: Claim, shards: Sequence[tuple[int, str, dict[str, Any], bytes]]) -> None:
        """Store shards that ended, each ``(number, content, document, data)``, in one transaction.

        ``content`` identifies what a shard depends on.
        A finished shard is progress that survives a lost worker, so the count of attempts starts again.
        Raises ``LeaseLost``.
        """
        numbers = [number for number, *_ in shards]
        with self._database.session(write=True) as session:
            change(session, claim, attempts=1)
            session.execute(
                delete(ShardRow).where(ShardRow.job_id == claim.job_id, ShardRow.number.in_(numbers))
            )
            session.execute(
                insert(ShardRow).values(created_at=after()),
                [
                    {
                        "job_id": claim.job_id,
                        "number": number,
                        "content": content,
                        "document": document,
                        "data": data,
                    }
                    for number, content, document, data in shards
                ],
            )

    def shard_contents(self, job_id: str) -> dict[int, str]:
        """Number and content of the finished shards."""
        query = select(ShardRow.number, ShardRow.content).where(ShardRow.job_id == job_id)
        with self._database.session() as session:
            return {number: content for number, content in session.execute(query)}

    def shards(self, job_id: str) -> tuple[Shard, ...]:
        """The finished shards in order, with their bytes."""
        query = select(ShardRow).where(ShardRow.job_id == job_id).order_by(ShardRow.number)
        with self._database.session() as session:
            return tuple(row.record() for row in session.scalars(query))

    def shard_documents(self, job_id: str) -> tuple[dict[str, Any], ...]:
        """The documents of the finished shards in order."""
        query = select(ShardRow.document).where(ShardRow.job_id == job_id).order_by(ShardRow.number)
        with self._database.session() as session:
            return tuple(session.scalars(query))

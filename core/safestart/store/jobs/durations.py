"""How long earlier runs of a process took: with the same inputs, and with others."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sqlalchemy import select

from safestart.store.database import Database
from safestart.store.jobs.submissions import request_hash
from safestart.store.models import JobRow
from safestart.store.records import JobStatus

_RECENT = 300
_MOST = 20


@dataclass(frozen=True, slots=True)
class Durations:
    """Seconds from start to end of successful runs, the latest first: with the same inputs, and with others."""

    same: tuple[float, ...]
    other: tuple[float, ...]


class Past:
    """Reads earlier runs."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def durations(self, process_id: str, inputs: dict[str, Any]) -> Durations:
        """Durations of the latest successful runs of a process, s; ``inputs`` are whole, with every default.

        Only the latest 300 runs are looked at, and of each kind at most 20 are told. Raises ``InvalidInput`` when the
        inputs are not JSON.
        """
        request = request_hash(process_id, inputs)
        query = (
            select(JobRow.request_sha256, JobRow.started_at, JobRow.finished_at)
            .where(JobRow.process_id == process_id, JobRow.status == JobStatus.SUCCESSFUL.value)
            .order_by(JobRow.seq.desc())
            .limit(_RECENT)
        )
        found: dict[bool, list[float]] = {True: [], False: []}
        with self._database.session() as session:
            for sha256, started, finished in session.execute(query):
                if started is not None and finished is not None:
                    found[sha256 == request].append(max((finished - started).total_seconds(), 0.0))
        return Durations(tuple(found[True][:_MOST]), tuple(found[False][:_MOST]))

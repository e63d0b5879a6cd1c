"""A store with the same runs every time: real results, with fixed identifiers, names, moments and durations."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from typing import Any

from sqlalchemy import select

from safestart.processes.execute import execute
from safestart.processes.outcome import outcome_of
from safestart.processes.registry import process
from safestart.records.labels import Labels
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.models import EventRow, JobRow

BEGIN = datetime(2026, 3, 2, 8, 0, tzinfo=UTC)
GRID = {"nx": 21, "ny": 21, "y_max_m": 150}
BENCHMARK = {"a_max_m_s2": 0.1, "grid": GRID, "engines": ["certified", "exact", "forward", "backward"]}
RUNS: dict[str, tuple[str, dict[str, Any], Labels]] = {
    "safety": (
        "passive-safety",
        process("passive-safety").example,
        Labels(name="Rendezvous with a failed thruster", tags=["review"]),
    ),
    "slow": (
        "benchmark",
        BENCHMARK | {"omega_t_deg_s": 1},
        Labels(name="Slow tumble", tags=["table 2"], note="The paper's first operating point."),
    ),
    "fast": (
        "benchmark",
        BENCHMARK | {"omega_t_deg_s": 3},
        Labels(name="Medium tumble", tags=["table 2", "review"]),
    ),
}
"""Finished runs by a short name: process, inputs, labels."""
WAITING = "waiting"


def fill(database_url: str) -> dict[str, str]:
    """Store the runs; the identifier of each by its short name. The others are cancelled, failed and waiting."""
    database = Database(database_url)
    database.migrate()
    jobs = JobRepository(database)
    found = {}
    for k, (name, (process_id, inputs, labels)) in enumerate(RUNS.items()):
        found[name] = _identifier(k)
        done = execute(process_id, inputs)
        document = _steady(done.document)
        jobs.submit(process_id, document["inputs"], timeout_s=600.0, job_id=found[name], labels=labels)
        claim = jobs.claim("worker", 60.0)
        assert claim is not None
        outcome = outcome_of(process_id, document["outputs"])
        jobs.succeed(claim, document, done.artifacts, {"safestart": "as tested"}, outcome)
    _others(jobs, found)
    _date(database)
    database.close()
    return found


def _others(jobs: JobRepository, found: dict[str, str]) -> None:
    ends = {"failed": "Shadow side", "cancelled": "Not needed any more", WAITING: "Night shift"}
    for k, (name, title) in enumerate(ends.items(), start=len(found)):
        found[name] = _identifier(k)
        labels = Labels(name=title, tags=["night"])
        inputs = {"omega_t_deg_s": 2.0 + k, "a_max_m_s2": 0.1}
        jobs.submit("benchmark", inputs, timeout_s=600.0, job_id=found[name], labels=labels)
        if name == WAITING:
            continue
        claim = jobs.claim("worker", 60.0)
        assert claim is not None
        if name == "failed":
            jobs.fail(claim, {"title": "Out of memory", "status": 500, "detail": "made by the test"})
        else:
            jobs.dismissed(claim)


def _identifier(k: int) -> str:
    return f"{k + 1:08x}-0000-4000-8000-{k + 1:012x}"


def _steady(document: dict[str, Any]) -> dict[str, Any]:
    """The document with fixed moments and durations: those of the run differ each time."""
    fixed = {"started": BEGIN.isoformat(), "finished": (BEGIN + timedelta(seconds=3)).isoformat()}
    outputs = {name: _timed(value) for name, value in document["outputs"].items()}
    return document | {"outputs": outputs, "provenance": document["provenance"] | fixed}


def _timed(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: 0.25 if key == "run_s" else _timed(inner) for key, inner in value.items()}
    return [_timed(inner) for inner in value] if isinstance(value, list) else value


def _date(database: Database) -> None:
    """Give every job and event its moment, an hour from one job to the next."""
    with database.session(write=True) as session:
        rows = session.scalars(select(JobRow).order_by(JobRow.seq)).all()
        for row, at in zip(rows, _hours(), strict=False):
            row.created_at = at
            if row.started_at is not None:
                row.started_at = at + timedelta(seconds=1)
            if row.finished_at is not None:
                row.finished_at = at + timedelta(seconds=4)
            row.updated_at = row.finished_at or at
            for k, event in enumerate(
                session.scalars(select(EventRow).where(EventRow.job_id == row.id).order_by(EventRow.id))
            ):
                event.at = at + timedelta(seconds=k)


def _hours() -> Iterator[datetime]:
    k = 0
    while True:
        yield BEGIN + timedelta(hours=k)
        k += 1

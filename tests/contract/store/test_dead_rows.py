"""A queue on PostgreSQL whose rows were written again and again since a vacuum: what was there costs nothing."""

from __future__ import annotations

import json
from typing import Any

import pytest
from sqlalchemy import Connection, event, text

from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from tests.contract.store.store_backends import NO_SERVER, POSTGRESQL, fresh_url
from tests.contract.store.store_jobs import claimed, submit

pytestmark = pytest.mark.skipif(not POSTGRESQL, reason=NO_SERVER)

ENDED = 5000
# Pages of indices, four at most in a statement, and some rows. The dead rows alone fill 250.
MOST_PAGES = 180


def test_what_was_in_the_queue_is_not_looked_through_again(tmp_path) -> None:
    database = Database(fresh_url("postgresql", tmp_path))
    database.migrate()
    jobs = JobRepository(database)
    with database.session(write=True) as session:
        session.execute(text("ALTER TABLE jobs SET (autovacuum_enabled = false)"))
    _succeed(database, jobs)

    asked: list[tuple[str, Any]] = []

    def heard(_connection: Connection, _cursor: Any, statement: str, parameters: Any, *_: Any) -> None:
        if statement.startswith("SELECT"):
            asked.append((statement, parameters))

    jobs.heartbeat("worker", 1, 1)
    for _ in range(2):  # the first look finds that they are gone
        asked.clear()
        event.listen(database._engine, "before_cursor_execute", heard)
        waiting = submit(jobs, "new", max_queued=10)
        assert jobs.wait(waiting.id) is not None
        assert jobs.positions([waiting.id]) == {waiting.id: 1}
        claim = claimed(jobs)
        event.remove(database._engine, "before_cursor_execute", heard)
        jobs.succeed(claim, {}, (), {})
    assert len(asked) > 8
    with database._engine.connect() as connection:
        pages = {
            statement: _pages(connection, statement, parameters)
            for statement, parameters in asked
            if "jobs" in statement
        }
    assert max(pages.values()) <= MOST_PAGES, json.dumps(pages, indent=2)


def _succeed(database: Database, jobs: JobRepository) -> None:
    """Jobs that waited, ran and succeeded: three rows each, two of them dead."""
    submit(jobs)
    jobs.succeed(claimed(jobs), {}, (), {})
    with database.session(write=True) as session:
        columns = session.scalars(
            text("SELECT column_name FROM information_schema.columns WHERE table_name = 'jobs'")
        ).all()
        kept = [name for name in columns if name not in ("seq", "id", "idempotency_key", "status")]
        session.execute(
            text(
                f"INSERT INTO jobs (id, status, {', '.join(kept)}) SELECT gen_random_uuid(), 'accepted', "
                f"{', '.join(kept)} FROM jobs, generate_series(1, {ENDED})"
            )
        )
    for before, after in (("accepted", "running"), ("running", "successful")):
        with database.session(write=True) as session:
            session.execute(text(f"UPDATE jobs SET status = '{after}' WHERE status = '{before}'"))


def _pages(connection: Connection, statement: str, parameters: Any) -> int:
    """Pages that a statement reads."""
    found = connection.exec_driver_sql(
        f"EXPLAIN (ANALYZE, BUFFERS, FORMAT JSON) {statement}", parameters
    ).scalar()
    plan = found[0]["Plan"]
    return int(plan["Shared Hit Blocks"] + plan["Shared Read Blocks"])

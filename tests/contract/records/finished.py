"""A job that has ended."""

from __future__ import annotations

from typing import Any

from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from tests.contract.api.service_client import SMALL


def done(database: Database, execution: Any, inputs: dict[str, Any] | None = None) -> str:
    """A finished job as a worker leaves it."""
    jobs = JobRepository(database)
    job = jobs.submit("benchmark", inputs or SMALL, timeout_s=60.0, submitter="somebody")
    claim = jobs.claim("worker", 30.0)
    assert claim is not None
    jobs.progress(claim, 50.0, "half", 1.0)
    jobs.succeed(claim, execution.document, execution.artifacts, {"python": "3"})
    return job.id

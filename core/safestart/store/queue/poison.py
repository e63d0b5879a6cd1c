"""Unfinished attempts: noted as they happen, and reported when they are too many."""

from __future__ import annotations

from collections import Counter
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from safestart.store.jobs.events import add_event
from safestart.store.models import EventRow

WORKER = "worker"
TASK_PROCESS = "task process"


def add_lost(session: Session, job_id: str, what: str, message: str) -> None:
    """Note in the job's events that an attempt was lost with its worker or its task process."""
    add_event(session, job_id, "log", {"message": message, "lost": what})


def poison(session: Session, job_id: str, most: int) -> dict[str, Any]:
    """The problem document of a job that has used up its ``most`` attempts."""
    query = select(EventRow.data).where(EventRow.job_id == job_id, EventRow.kind == "log")
    lost = Counter(data["lost"] for data in session.scalars(query) if "lost" in data)
    ends = []
    # No worker took over the lease that has just run out, so no event mentions it.
    workers, deaths = most - lost[TASK_PROCESS], lost[TASK_PROCESS]
    if workers > 0:
        ends.append(f"{workers} times its worker was lost")
    if deaths > 0:
        ends.append(f"{deaths} times its task process died (memory limit or crash)")
    return {
        "type": "urn:safestart:problem:poison",
        "title": "Too many attempts",
        "status": 500,
        "detail": (
            f"the job was started {most} times and never ended: {' and '.join(ends)}; at most {most} "
            "attempts are made"
        ),
    }

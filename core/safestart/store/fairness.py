"""Turns: how jobs of equal priority are served fairly among their submitters.

Start-time fair queueing with equal shares. Every waiting job has a turn; lower turns are served first, equal ones in
the order of submission. A new job takes the turn that is being served, or the one after the last of its own submitter:
who has a thousand jobs waiting holds a thousand turns in a row, and the first job of anybody else comes after one of
them. With a single submitter this is the order of submission.
"""

from __future__ import annotations

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from safestart.store.models import JobRow
from safestart.store.records import JobStatus


def next_turn(session: Session, submitter: str, priority: int) -> int:
    """The turn of a job that ``submitter`` submits at ``priority``."""
    waits = (JobRow.status == JobStatus.ACCEPTED.value, JobRow.priority == priority)
    runs = (JobRow.status == JobStatus.RUNNING.value, JobRow.priority == priority)
    served = session.scalar(select(func.min(JobRow.turn)).where(*waits))
    if served is None:  # nobody waits: a running job that comes back to the queue must not come last
        served = session.scalar(select(func.max(JobRow.turn)).where(*runs)) or 0
    own = session.scalar(select(func.max(JobRow.turn)).where(*waits, JobRow.submitter == submitter))
    return served if own is None else max(served, own + 1)

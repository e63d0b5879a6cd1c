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
    turn, among = JobRow.turn, JobRow.priority == priority
    waits = among & (JobRow.status == JobStatus.ACCEPTED.value)
    runs = among & (JobRow.status == JobStatus.RUNNING.value)
    # A job that came back to the queue has an old turn: who took that would be ahead of all that wait.
    fresh = select(turn).where(waits, JobRow.token == 0).order_by(turn).limit(1)
    # One statement: other submissions wait meanwhile.
    served, waiting, running, own = session.execute(
        select(
            fresh.scalar_subquery(),
            # Two, as each is read off the end of the queue's index.
            select(func.max(turn)).where(waits).scalar_subquery(),
            select(func.max(turn)).where(runs).scalar_subquery(),
            select(func.max(turn)).where(waits, JobRow.submitter == submitter).scalar_subquery(),
        )
    ).one()
    if served is None:  # none waits for its first time: one that comes back to the queue must not come last
        served = max(waiting or 0, running or 0)
    return int(served if own is None else max(served, own + 1))

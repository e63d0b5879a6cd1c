"""Turns: the queue serves jobs of equal priority fairly among their submitters.

This is start-time fair queueing with equal shares. Every waiting job has a turn; lower turns are served first,
equal turns in the order of submission. A new job takes the turn being served, or the turn after the last job of its
own submitter if that is later. A submitter with a thousand waiting jobs holds a thousand turns in a row, so another
submitter's first job waits for only one of them. With a single submitter this is the order of submission.
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
    # A job that came back to the queue has an old turn; a new job with that turn would pass all waiting jobs.
    fresh = select(turn).where(waits, JobRow.token == 0).order_by(turn).limit(1)
    # One statement, because other submissions wait meanwhile.
    served, waiting, running, own = session.execute(
        select(
            fresh.scalar_subquery(),
            # Two queries, as each reads only the end of the queue's index.
            select(func.max(turn)).where(waits).scalar_subquery(),
            select(func.max(turn)).where(runs).scalar_subquery(),
            select(func.max(turn)).where(waits, JobRow.submitter == submitter).scalar_subquery(),
        )
    ).one()
    if served is None:  # no new job waits, and a returned job must not end up behind later jobs
        served = max(waiting or 0, running or 0)
    return int(served if own is None else max(served, own + 1))

"""When a lease has run out, on the database's clock, whichever way that clock was set meanwhile."""

from __future__ import annotations

from sqlalchemy import ColumnElement, and_, or_

from safestart.store.dialect import after
from safestart.store.models import JobRow
from safestart.store.records import JobStatus


def expired() -> ColumnElement[bool]:
    """A running job whose lease has run out.

    A lease that ends further ahead than twice its own length was written before the clock was set back: without this
    its job would be stuck for as long as the clock has gone back. Where the clock jumps, a job whose worker lives
    may be taken over; its old worker is then refused, as any late writer is.
    """
    run_out = JobRow.lease_expires_at < after()
    set_back = and_(JobRow.lease_s.is_not(None), JobRow.lease_expires_at > after(2 * JobRow.lease_s))
    return and_(JobRow.status == JobStatus.RUNNING.value, or_(run_out, set_back))

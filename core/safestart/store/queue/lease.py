"""When a lease has run out by the database's clock, even if that clock was set meanwhile."""

from __future__ import annotations

from sqlalchemy import ColumnElement, and_, or_

from safestart.store.dialect import after
from safestart.store.models import JobRow
from safestart.store.records import JobStatus


def expired() -> ColumnElement[bool]:
    """Condition: a running job whose lease has run out.

    A lease that ends more than twice its length ahead was written before the clock was set back; without this
    condition its job would be stuck for the time set back. After a clock jump another worker may take over the job
    of a living worker; the store then refuses the old one, as any late writer.
    """
    run_out = JobRow.lease_expires_at < after()
    set_back = and_(JobRow.lease_s.is_not(None), JobRow.lease_expires_at > after(2 * JobRow.lease_s))
    return and_(JobRow.status == JobStatus.RUNNING.value, or_(run_out, set_back))

"""Find a job by its id."""

from __future__ import annotations

from sqlalchemy import select
from sqlalchemy.orm import Session

from safestart.errors import NotFound
from safestart.store.models import JobRow


def find(session: Session, job_id: str) -> JobRow:
    """The row of a job; raises ``NotFound``."""
    row = session.scalar(select(JobRow).where(JobRow.id == job_id).execution_options(populate_existing=True))
    if row is None:
        raise NotFound(f"no job {job_id!r}", field="jobID", required="the id of a job", received=job_id)
    return row

"""Changes to a job by the worker that holds it: conditional updates that name the claim's token."""

from __future__ import annotations

from typing import Any

from sqlalchemy import update
from sqlalchemy.orm import Session

from safestart.errors import LeaseLost
from safestart.store.dialect import after
from safestart.store.models import JobRow
from safestart.store.records import Claim, JobStatus


def try_change(session: Session, claim: Claim, *conditions: Any, **values: Any) -> bool:
    """Update the claimed job if the claim still holds (and ``conditions`` are met)."""
    query = (
        update(JobRow)
        .where(
            JobRow.id == claim.job_id,
            JobRow.status == JobStatus.RUNNING.value,
            JobRow.owner == claim.owner,
            JobRow.token == claim.token,
            *conditions,
        )
        .values(updated_at=after(), **values)
        .execution_options(synchronize_session=False)
    )
    return bool(session.execute(query).rowcount)  # type: ignore[attr-defined]


def change(session: Session, claim: Claim, **values: Any) -> None:
    """Update the claimed job; raises ``LeaseLost``."""
    if not try_change(session, claim, **values):
        raise LeaseLost(
            f"job {claim.job_id} is no longer held by {claim.owner}, claim {claim.token}; nothing written",
            required="a claim that still holds",
            received=claim.token,
        )

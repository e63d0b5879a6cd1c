"""Changes to a job by its worker: conditional updates on the claim's token.

Each statement is built once, because building takes longer than running: values of plain columns are parameters,
and the database's clock is part of the statement.
"""

from __future__ import annotations

from typing import Any

from sqlalchemy import Float, Update, bindparam, update
from sqlalchemy.orm import Session

from safestart.errors import LeaseLost
from safestart.store.dialect import after
from safestart.store.models import JobRow, table
from safestart.store.records import Claim, JobStatus

JOBS = table(JobRow)
FREE: dict[str, Any] = {"owner": None, "lease_expires_at": None, "lease_s": None, "eta_s": None}
"""Columns of a job that nobody holds."""
LEASE: dict[str, Any] = {"lease_expires_at": after(bindparam("lease_for", type_=Float()))}
"""A lease of ``lease_for`` seconds from now."""
HELD = (
    update(JOBS)
    .where(
        JOBS.c.id == bindparam("held_id"),
        JOBS.c.status == JobStatus.RUNNING.value,
        JOBS.c.owner == bindparam("held_owner"),
        JOBS.c.token == bindparam("held_token"),
    )
    .values(updated_at=after())
)
"""The update of a job while its claim holds."""
WANTED = HELD.where(JOBS.c.cancel_requested.is_(False))
"""... and its dismissal was not asked for."""


def try_change(session: Session, claim: Claim, statement: Update = HELD, **values: Any) -> bool:
    """Set ``values`` on the claimed job by ``statement``, which begins with ``HELD``; False if no row matched."""
    held = {"held_id": claim.job_id, "held_owner": claim.owner, "held_token": claim.token}
    return bool(session.execute(statement, held | values).rowcount)  # type: ignore[attr-defined]


def change(session: Session, claim: Claim, statement: Update = HELD, **values: Any) -> None:
    """Update the claimed job; raises ``LeaseLost``."""
    if not try_change(session, claim, statement, **values):
        raise LeaseLost(
            f"job {claim.job_id} is no longer held by {claim.owner}, claim {claim.token}; nothing written",
            required="a claim that is still valid",
            received=claim.token,
        )

"""Counters of rare events; they outlive the jobs that they counted."""

from __future__ import annotations

from enum import StrEnum

from sqlalchemy import select, update
from sqlalchemy.orm import Session

from safestart.store.models import TallyRow


class Tally(StrEnum):
    """The counters; the migrations add a row for each."""

    LEASE_LOSSES = "lease_losses"
    TASK_DEATHS = "task_deaths"
    POISONED = "poisoned"


def count(session: Session, what: Tally) -> None:
    """Add one. Call it last in a transaction, as the row stays locked until the end."""
    session.execute(update(TallyRow).where(TallyRow.name == what.value).values(number=TallyRow.number + 1))


def tallies(session: Session) -> dict[str, int]:
    """All counters by name."""
    return {name: number for name, number in session.execute(select(TallyRow.name, TallyRow.number))}

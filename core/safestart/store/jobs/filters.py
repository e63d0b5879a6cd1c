"""The filter of a job list; free of SQLAlchemy, because the service builds it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from safestart.store.records import JobStatus


@dataclass(frozen=True, slots=True)
class JobFilter:
    """Conditions that a job must all meet; an empty or None field sets no condition.

    ``created_from`` and ``created_to`` are inclusive. A job's duration, s, runs from its start to its end, or to
    now while it runs; a job that never started meets no condition on it. Each of ``words`` must occur in the job's id,
    process, name or a tag, in small or capital letters; ``tags`` are whole tags; ``verdicts`` the words of outcomes.
    """

    statuses: Sequence[JobStatus] = ()
    process_ids: Sequence[str] = ()
    submitter: str | None = None
    created_from: datetime | None = None
    created_to: datetime | None = None
    least_s: float | None = None
    most_s: float | None = None
    words: Sequence[str] = ()
    tags: Sequence[str] = ()
    verdicts: Sequence[str] = ()


EVERY = JobFilter()
"""All jobs."""


class Order(StrEnum):
    """What a list is sorted by; ties, and jobs without a value, follow from the newest to the oldest."""

    CREATED = "created"
    DURATION = "duration"
    PROCESS = "processID"
    NAME = "name"
    STATUS = "status"
    VERDICT = "verdict"
    SUBMITTER = "submitter"

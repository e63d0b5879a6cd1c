"""Filters of the job list in SQL."""

from __future__ import annotations

from collections.abc import Iterator

from sqlalchemy import ColumnElement, func

from safestart.store.dialect import after, seconds_between
from safestart.store.jobs.filters import JobFilter
from safestart.store.models import JobRow
from safestart.store.records import JobStatus


def conditions(wanted: JobFilter) -> Iterator[ColumnElement[bool]]:
    """The conditions of a filter on the table of jobs."""
    if wanted.statuses:
        yield JobRow.status.in_([JobStatus(status).value for status in wanted.statuses])
    if wanted.process_ids:
        yield JobRow.process_id.in_(wanted.process_ids)
    if wanted.submitter is not None:
        yield JobRow.submitter == wanted.submitter
    if wanted.created_from is not None:
        yield JobRow.created_at >= wanted.created_from
    if wanted.created_to is not None:
        yield JobRow.created_at <= wanted.created_to
    duration = seconds_between(JobRow.started_at, func.coalesce(JobRow.finished_at, after()))
    if wanted.least_s is not None:
        yield duration >= wanted.least_s
    if wanted.most_s is not None:
        yield duration <= wanted.most_s

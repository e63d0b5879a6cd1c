"""Filters and orders of the job list in SQL."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from sqlalchemy import ColumnElement, Select, func, select
from sqlalchemy.orm import aliased

from safestart.store.dialect import after, holds, seconds_between
from safestart.store.jobs.filters import JobFilter, Order
from safestart.store.jobs.labelling import of_tag
from safestart.store.models import JobRow
from safestart.store.records import JobStatus


def matching(wanted: JobFilter) -> Select[int] | None:
    """The numbers of the jobs with the words and tags of a filter; None for a filter without.

    It is a query of its own, which an index alone answers: rows hold their inputs.
    """
    texts = [word.lower() for word in wanted.words] + [of_tag(tag) for tag in wanted.tags]
    if not texts:
        return None
    row = aliased(JobRow)
    return select(row.seq).where(*(holds(row.search.expression, text) for text in texts))


def conditions(wanted: JobFilter) -> Iterator[ColumnElement[bool]]:
    """The conditions of a filter on the table of jobs, all but its words and tags."""
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
    if wanted.verdicts:
        yield JobRow.verdict.in_(wanted.verdicts)
    duration = _duration()
    if wanted.least_s is not None:
        yield duration >= wanted.least_s
    if wanted.most_s is not None:
        yield duration <= wanted.most_s


def _duration() -> ColumnElement[float]:
    return seconds_between(JobRow.started_at, func.coalesce(JobRow.finished_at, after()))


def order_of(by: Order, *, descending: bool) -> tuple[ColumnElement[Any], ...]:
    """The order of a list in SQL."""
    if by is Order.CREATED:
        return (JobRow.seq.desc() if descending else JobRow.seq.asc(),)
    keys: dict[Order, ColumnElement[Any]] = {
        Order.DURATION: _duration(),
        Order.PROCESS: JobRow.process_id.expression,
        Order.NAME: func.nullif(func.lower(JobRow.name), ""),
        Order.STATUS: JobRow.status.expression,
        Order.VERDICT: JobRow.verdict.expression,
        Order.SUBMITTER: func.nullif(JobRow.submitter, ""),
    }
    key = keys[by]
    return (key.desc() if descending else key.asc()).nulls_last(), JobRow.seq.desc()

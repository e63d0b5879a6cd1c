"""The list of jobs: filtered, sorted, a page at a time."""

from __future__ import annotations

from base64 import urlsafe_b64decode, urlsafe_b64encode
from collections.abc import Sequence
from dataclasses import fields
from typing import Any

from sqlalchemy import ColumnElement, Row, Text, case, cast, exists, func, select
from sqlalchemy.orm import Session

from safestart.errors import InvalidInput, invalid
from safestart.store.database import Database
from safestart.store.jobs.conditions import conditions, matching, order_of
from safestart.store.jobs.filters import EVERY, JobFilter, Order
from safestart.store.models import JobRow, table
from safestart.store.records import JobEntry, JobPage, JobStatus

MAX_PAGE = 1000
MAX_OFFSET = 10_000_000
_SHORT_INPUTS = 20_000
_FEW = 1000
_BEFORE, _AFTER = "before:", "after:"
_JOBS = table(JobRow)
_INPUTS = case((func.length(cast(_JOBS.c.inputs, Text)) <= _SHORT_INPUTS, _JOBS.c.inputs)).label("inputs")
_ENTRY = (*(_JOBS.c[name] for name in ("seq", *(field.name for field in fields(JobEntry)))), _INPUTS)


class Listing:
    """Reads lists of jobs."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def list(
        self,
        wanted: JobFilter = EVERY,
        *,
        limit: int = 50,
        cursor: str | None = None,
        offset: int = 0,
        by: Order = Order.CREATED,
        descending: bool = True,
    ) -> JobPage:
        """A page of the jobs that meet ``wanted``, newest first unless sorted ``by`` something else.

        Pages by ``cursor`` never shift, whatever is submitted meanwhile; they are for the newest first. Pages of every
        order are by ``offset``, the number of jobs before them. Raises ``InvalidInput`` on a cursor that did not come
        from here, and on one with an offset or in another order.
        """
        if not 1 <= limit <= MAX_PAGE:
            raise invalid("limit", f"an integer in [1, {MAX_PAGE}]", limit)
        if not 0 <= offset <= MAX_OFFSET:
            raise invalid("offset", f"an integer in [0, {MAX_OFFSET}]", offset)
        by_cursor = by is Order.CREATED and descending and offset == 0
        if cursor is not None and not by_cursor:
            raise invalid("cursor", "none with an offset or another order than the newest first", cursor)
        with self._database.session() as session:
            meets, many = _met(session, wanted)
            order = order_of(by, descending=descending)
            if many and cursor is None:
                # A search that finds many reads all texts: once for the number of jobs and the page.
                numbers, total = _counted(session, meets, order, limit + by_cursor, offset)
                older = _encode(_BEFORE, numbers[limit - 1]) if len(numbers) > limit else None
                return _page(_rows(session, numbers[:limit]), older, None, total)
            total = session.scalar(select(func.count()).select_from(JobRow).where(*meets)) or 0
            if by_cursor:
                return _beside(session, meets, limit, cursor, total)
            query = select(JobRow.seq).where(*meets).order_by(*order).limit(limit).offset(offset)
            return _page(_rows(session, session.scalars(query).all()), None, None, total)


_Conditions = tuple[ColumnElement[bool], ...]


def _met(session: Session, wanted: JobFilter) -> tuple[_Conditions, bool]:
    """The conditions of a filter, and whether many jobs have its words and tags.

    Few are looked up once for the page, its count and its ends.
    """
    others, query = tuple(conditions(wanted)), matching(wanted)
    if query is None:
        return others, False
    numbers = session.scalars(query.limit(_FEW + 1)).all()
    many = len(numbers) > _FEW
    return (*others, JobRow.seq.in_(query if many else numbers)), many


def _counted(
    session: Session, meets: _Conditions, order: Sequence[ColumnElement[Any]], limit: int, offset: int
) -> tuple[list[int], int]:
    """Numbers of a page's jobs, and how many meet the conditions."""
    query = select(JobRow.seq, func.count().over().label("total")).where(*meets)
    rows = session.execute(query.order_by(*order).limit(limit).offset(offset)).all()
    if rows or not offset:
        return [row.seq for row in rows], rows[0].total if rows else 0
    return [], session.scalar(select(func.count()).select_from(JobRow).where(*meets)) or 0


def _rows(session: Session, numbers: Sequence[int]) -> list[Row[Any]]:
    """The rows of these jobs, in their order."""
    rows = {row.seq: row for row in session.execute(select(*_ENTRY).where(JobRow.seq.in_(numbers)))}
    return [rows[number] for number in numbers]


def _beside(session: Session, meets: _Conditions, limit: int, cursor: str | None, total: int) -> JobPage:
    newer, seq = (False, None) if cursor is None else _decode(cursor)
    query = select(*_ENTRY).where(*meets).limit(limit + 1)
    if seq is not None:
        query = query.where(JobRow.seq > seq if newer else JobRow.seq < seq)
    rows = list(session.execute(query.order_by(JobRow.seq if newer else JobRow.seq.desc())))
    more = len(rows) > limit
    rows = rows[:limit][::-1] if newer else rows[:limit]
    if not rows or seq is None:
        others = False
    else:  # on the side that the client came from
        beyond = JobRow.seq < rows[-1].seq if newer else JobRow.seq > rows[0].seq
        others = bool(session.scalar(select(exists().where(*meets, beyond))))
    older, later = (others, more) if newer else (more, others)
    return _page(
        rows,
        _encode(_BEFORE, rows[-1].seq) if older else None,
        _encode(_AFTER, rows[0].seq) if later else None,
        total,
    )


def _page(rows: list[Row[Any]], older: str | None, later: str | None, total: int) -> JobPage:
    return JobPage(tuple(map(_entry, rows)), older, later, tuple(row.inputs for row in rows), total)


def _entry(row: Row[Any]) -> JobEntry:
    values = {field.name: getattr(row, field.name) for field in fields(JobEntry)}
    return JobEntry(**values | {"status": JobStatus(row.status)})


def _encode(kind: str, seq: int) -> str:
    return urlsafe_b64encode(f"{kind}{seq}".encode()).decode().rstrip("=")


def _decode(cursor: str) -> tuple[bool, int]:
    """Direction and start of a page: True for newer jobs, and the number of the job beside the page."""
    required = "the next_cursor or prev_cursor of an earlier page"
    try:
        text = urlsafe_b64decode(cursor + "=" * (-len(cursor) % 4)).decode("ascii")
    except ValueError:
        raise invalid("cursor", required, cursor) from None
    newer = text.startswith(_AFTER)
    number = text.removeprefix(_AFTER if newer else _BEFORE)
    if number == text or not (number.isascii() and number.isdigit()) or len(number) > 18:
        raise InvalidInput(
            f"cursor: required {required}, received {cursor!r}",
            field="cursor",
            required=required,
            received=cursor,
        )
    return newer, int(number)

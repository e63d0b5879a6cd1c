"""The waiting jobs: place in the queue, and an estimate of when each starts and ends."""

from __future__ import annotations

from collections.abc import Iterable
from statistics import fmean

from sqlalchemy import ColumnElement, case, func, or_, select
from sqlalchemy.orm import Session

from safestart.store.database import Database
from safestart.store.jobs.finding import find
from safestart.store.models import JobRow, table
from safestart.store.queue.presence import crew_of
from safestart.store.records import JobStatus, Run, Wait

# Number of latest jobs from which run times are taken.
RECENT = 200
_JOBS = table(JobRow)
_WAITS = _JOBS.c.status == JobStatus.ACCEPTED.value


class Queue:
    """Reading side of the queue."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def position(self, job_id: str) -> int | None:
        """Place in the queue, 1 = next; None unless the job waits. Raises ``NotFound``."""
        return self.positions([self._known(job_id)]).get(job_id)

    def positions(self, job_ids: Iterable[str]) -> dict[str, int]:
        """Places of the waiting jobs among the given ones."""
        wanted = list(job_ids)
        if not wanted:
            return {}
        # Select by id alone and check the status afterwards; with the status SQLite would read all waiting jobs.
        ends = select(_JOBS.c.priority, _JOBS.c.turn, _JOBS.c.status).where(_JOBS.c.id.in_(wanted))
        with self._database.session() as session:
            rows = session.execute(ends).all()
            asked = sorted(
                (-row.priority, row.turn) for row in rows if row.status == JobStatus.ACCEPTED.value
            )
            if not asked:
                return {}
            (first, first_turn), (last, last_turn) = asked[0], asked[-1]
            between = _JOBS.c.priority.between(-last, -first)
            ahead = select(func.count()).where(_WAITS, _JOBS.c.priority > -first)
            if first == last:
                same = _JOBS.c.priority == -first
                between = same & _JOBS.c.turn.between(first_turn, last_turn)
                # Two counts, as each can use the queue's index.
                before = select(func.count()).where(_WAITS, same, _JOBS.c.turn < first_turn)
                ahead = select(ahead.scalar_subquery() + before.scalar_subquery())
            # Number only the jobs between the first and the last requested, few on a page of the list. This reads
            # the index alone, and the ids are looked up for those few.
            order = (_JOBS.c.priority.desc(), _JOBS.c.turn, _JOBS.c.seq)
            place = func.row_number().over(order_by=order).label("place")
            queue = select(_JOBS.c.seq, place).where(_WAITS, between).subquery()
            query = select(_JOBS.c.id, queue.c.place).join(queue, queue.c.seq == _JOBS.c.seq)
            found = session.execute(query.where(_JOBS.c.id.in_(wanted))).all()
            number = session.scalar(ahead) or 0
            return {job: number + place for job, place in found}

    def wait(self, job_id: str) -> Wait | None:
        """Place of a waiting job and the estimates for it; None unless it waits. Raises ``NotFound``.

        The estimate divides the seconds of work ahead, from the mean run time of each process's latest jobs, by the
        places of the living workers. It needs one ended job and one worker.
        """
        with self._database.session() as session:
            row = find(session, job_id)
            if row.status != JobStatus.ACCEPTED.value:
                return None
            ahead, higher, turns = _ahead(session, row)
            position = 1 + sum(ahead.values())
            crew, means = crew_of(session), _mean_run_s(session)
            if not means or not crew.places:
                return Wait(position, None, None, higher, turns)
            other = fmean(means.values())
            own = means.get(row.process_id, other)
            if position <= crew.places - crew.busy:
                return Wait(position, 0.0, own, higher, turns)
            work = sum(number * means.get(process, other) for process, number in ahead.items())
            running = select(JobRow.process_id, JobRow.eta_s).where(JobRow.status == JobStatus.RUNNING.value)
            for process, eta_s in session.execute(running):
                work += means.get(process, other) / 2 if eta_s is None else eta_s
            starts = work / crew.places
            return Wait(position, starts, starts + own, higher, turns)

    def _known(self, job_id: str) -> str:
        with self._database.session() as session:
            return find(session, job_id).id


def _before(row: JobRow) -> ColumnElement[bool]:
    """Conditions for jobs served before ``row``."""
    same_turn = (JobRow.turn == row.turn) & (JobRow.seq < row.seq)
    same_priority = (JobRow.priority == row.priority) & or_(JobRow.turn < row.turn, same_turn)
    return or_(JobRow.priority > row.priority, same_priority)


def _ahead(session: Session, row: JobRow) -> tuple[dict[str, int], int, int]:
    """Jobs ahead of ``row`` by process; how many are ahead by priority, and how many later ones by their turn."""
    higher = JobRow.priority > row.priority
    later = (JobRow.priority == row.priority) & (JobRow.seq > row.seq)
    columns = (
        JobRow.process_id,
        func.count(),
        func.sum(case((higher, 1), else_=0)),
        func.sum(case((later, 1), else_=0)),
    )
    query = select(*columns).where(_WAITS, _before(row)).group_by(JobRow.process_id)
    found = session.execute(query).all()
    return (
        {item[0]: item[1] for item in found},
        sum(item[2] for item in found),
        sum(item[3] for item in found),
    )


def runs(session: Session) -> tuple[Run, ...]:
    """The successful jobs that ended last."""
    query = (
        select(JobRow.process_id, JobRow.created_at, JobRow.started_at, JobRow.finished_at)
        .where(JobRow.status == JobStatus.SUCCESSFUL.value, JobRow.started_at.is_not(None))
        .order_by(JobRow.finished_at.desc())
        .limit(RECENT)
    )
    return tuple(
        Run(
            process,
            max((started - created).total_seconds(), 0.0),
            max((finished - started).total_seconds(), 0.0),
        )
        for process, created, started, finished in session.execute(query)
        if started is not None and finished is not None
    )


def _mean_run_s(session: Session) -> dict[str, float]:
    """Mean run time of the latest successful jobs, by process."""
    times: dict[str, list[float]] = {}
    for run in runs(session):
        times.setdefault(run.process_id, []).append(run.run_s)
    return {process: fmean(values) for process, values in times.items()}

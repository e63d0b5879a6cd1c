"""Which workers live: heartbeats by the database's clock."""

from __future__ import annotations

from sqlalchemy import delete, func, insert, select, update
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from safestart.store.database import Database
from safestart.store.dialect import after
from safestart.store.models import WorkerRow
from safestart.store.records import Crew

ALIVE_S = 15.0
_FORGET_S = 86_400.0


class Presence:
    """Heartbeats of workers."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def heartbeat(self, owner: str, capacity: int, busy: int) -> None:
        """Say that ``owner`` is alive, with room for ``capacity`` jobs of which ``busy`` run."""
        values = {"capacity": capacity, "busy": busy, "heartbeat_at": after()}
        again = update(WorkerRow).where(WorkerRow.owner == owner).values(**values)
        with self._database.session(write=True) as session:
            if session.execute(again).rowcount:  # type: ignore[attr-defined]
                return
            session.execute(delete(WorkerRow).where(WorkerRow.heartbeat_at < after(-_FORGET_S)))
            try:
                with session.begin_nested():
                    session.execute(insert(WorkerRow).values(owner=owner, **values))
            except IntegrityError:
                session.execute(again)

    def farewell(self, owner: str) -> None:
        """Forget a worker that stopped normally."""
        with self._database.session(write=True) as session:
            session.execute(delete(WorkerRow).where(WorkerRow.owner == owner))

    def owners_alive(self, within_s: float = ALIVE_S) -> tuple[str, ...]:
        """Names of the workers with a heartbeat in the last ``within_s`` seconds."""
        query = select(WorkerRow.owner).where(WorkerRow.heartbeat_at >= after(-within_s))
        with self._database.session() as session:
            return tuple(session.scalars(query))

    def crew(self, within_s: float = ALIVE_S) -> Crew:
        """The workers with a heartbeat in the last ``within_s`` seconds and their places."""
        with self._database.session() as session:
            return crew_of(session, within_s)


def crew_of(session: Session, within_s: float = ALIVE_S) -> Crew:
    """The living workers, in this transaction."""
    query = select(func.count(), func.sum(WorkerRow.capacity), func.sum(WorkerRow.busy)).where(
        WorkerRow.heartbeat_at >= after(-within_s)
    )
    workers, places, busy = session.execute(query).one()
    return Crew(workers, int(places or 0), int(busy or 0))

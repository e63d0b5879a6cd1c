"""Who is there to work: heartbeats of the workers, on the database's clock."""

from __future__ import annotations

from sqlalchemy import delete, func, insert, select, update
from sqlalchemy.exc import IntegrityError

from safestart.store.database import Database
from safestart.store.dialect import after
from safestart.store.models import WorkerRow

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
        """Forget a worker that stopped in good order."""
        with self._database.session(write=True) as session:
            session.execute(delete(WorkerRow).where(WorkerRow.owner == owner))

    def workers_alive(self, within_s: float = ALIVE_S) -> int:
        """Number of workers heard of within the last ``within_s`` seconds."""
        query = select(func.count()).where(WorkerRow.heartbeat_at >= after(-within_s))
        with self._database.session() as session:
            return session.scalar(query) or 0

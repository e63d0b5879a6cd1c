"""The part of the store that answers use, in the service and in its helper processes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from safestart.runtime.cache import Shelf
from safestart.runtime.settings import Settings

if TYPE_CHECKING:
    from safestart.store.database import Database
    from safestart.store.jobs.repository import JobRepository


@dataclass(frozen=True, slots=True)
class Store:
    """Settings, jobs and the cache of earlier results."""

    settings: Settings
    jobs: JobRepository
    shelf: Shelf

    @classmethod
    def over(cls, settings: Settings, database: Database) -> Store:
        """The store in a database; it connects at first use."""
        from safestart.store.cache import Cache
        from safestart.store.jobs.repository import JobRepository

        return cls(settings, JobRepository(database), Cache(database))

"""State shared by the routes: settings and repositories, opened and closed with the application."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastapi import FastAPI, Request

from safestart.runtime.settings import Settings
from safestart_service.access.gate import Access
from safestart_service.access.keyring import Keyring
from safestart_service.computing.heavy import Helpers
from safestart_service.computing.helpers.sources import Source
from safestart_service.computing.light import Threads
from safestart_service.computing.store import Store
from safestart_service.http.following import Following
from safestart_service.metrics import Metrics

if TYPE_CHECKING:
    from safestart.store.database import Database

MOST_LIGHT = MOST_SUBMITTED = 400
"""Limits on light answers and on submissions that are under way or wait for it."""
MOST_PACKED = 20
LIGHT_THREADS, STORE_THREADS = 2, 8


class Services:
    """Settings, repositories, metrics and the pools that compute answers, of one application.

    The store is imported at its first use; the instant answers and the API description do not need it.
    """

    def __init__(
        self, settings: Settings, database: Database | None = None, source: Source | None = None
    ) -> None:
        from safestart.store.access.audit import AuditLog
        from safestart.store.access.keys import KeyRepository
        from safestart.store.database import Database
        from safestart.store.jobs.results import ResultRepository

        self.settings = settings
        self.database = database or Database(settings.url())
        self.store = Store.over(settings, self.database)
        self.jobs = self.store.jobs
        self.results = ResultRepository(self.database)
        self.keys = KeyRepository(self.database)
        self.audit = AuditLog(self.database)
        self.keyring = Keyring(self.keys)
        self.access = Access(settings, self.keyring)
        self.light = Threads("answers are being computed", LIGHT_THREADS, MOST_LIGHT)
        self.submitting = Threads("submissions are under way", STORE_THREADS, MOST_SUBMITTED)
        self.packing = Threads("bundles are being packed", 1, MOST_PACKED)  # one at a time: it is in memory
        self.helpers = Helpers(settings, source)
        self._pools = (self.light, self.submitting, self.packing, self.helpers)
        self._closed = False
        self.following = Following(settings.max_followers, self.access)
        self.metrics = Metrics(self.jobs.vitals)

    def open(self) -> None:
        """Begin; what was closed before begins again."""
        if self._closed:
            self._closed = False
            for pool in self._pools:
                pool.open()

    def close(self) -> None:
        """Close all that was opened."""
        self._closed = True
        for pool in self._pools:
            pool.close()
        self.database.close()


def services(request: Request) -> Services:
    """The services of the application that serves this request."""
    found: Services = request.app.state.services
    return found


def attach(app: FastAPI, found: Services) -> None:
    """Give an application its services."""
    app.state.services = found

"""State shared by the routes: settings and repositories, opened and closed with the application."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastapi import FastAPI, Request

from safestart.runtime.progress import Context
from safestart.runtime.settings import Settings
from safestart_service.access.callers import Callers
from safestart_service.access.gate import Access
from safestart_service.access.keyring import Keyring
from safestart_service.http.following import Following
from safestart_service.metrics import Metrics

if TYPE_CHECKING:
    from safestart.store.database import Database

MOST_COMPUTED = 400
"""Limit on answers that are being computed or wait for it."""


class Services:
    """Settings, repositories, metrics and the context of instant answers of one application.

    The store is imported at its first use; the instant answers and the API description do not need it.
    """

    def __init__(self, settings: Settings, database: Database | None = None) -> None:
        from safestart.store.access.audit import AuditLog
        from safestart.store.access.keys import KeyRepository
        from safestart.store.cache import Cache
        from safestart.store.database import Database
        from safestart.store.jobs.repository import JobRepository
        from safestart.store.jobs.results import ResultRepository

        self.settings = settings
        self.database = database or Database(settings.url())
        self.jobs = JobRepository(self.database)
        self.results = ResultRepository(self.database)
        self.keys = KeyRepository(self.database)
        self.audit = AuditLog(self.database)
        self.keyring = Keyring(self.keys)
        self.access = Access(settings, self.keyring)
        self.context = Context(shelf=Cache(self.database))
        self.computing = Callers("answers are being computed", MOST_COMPUTED)
        self.following = Following(settings.max_followers, self.access)
        self.metrics = Metrics(self.jobs.vitals)


def services(request: Request) -> Services:
    """The services of the application that serves this request."""
    found: Services = request.app.state.services
    return found


def attach(app: FastAPI, found: Services) -> None:
    """Give an application its services."""
    app.state.services = found

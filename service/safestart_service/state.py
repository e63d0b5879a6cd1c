"""What the routes share: settings and the repositories, opened with the application and closed with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastapi import FastAPI, Request

from safestart.settings import Settings
from safestart_service.metrics import Metrics

if TYPE_CHECKING:
    from safestart.store.database import Database


class Services:
    """Settings, repositories and metrics of one application.

    The store is imported when it is first needed: the instant answers and the API description do without.
    """

    def __init__(self, settings: Settings, database: Database | None = None) -> None:
        from safestart.store.database import Database
        from safestart.store.jobs import JobRepository
        from safestart.store.results import ResultRepository

        self.settings = settings
        self.database = database or Database(settings.url())
        self.jobs = JobRepository(self.database)
        self.results = ResultRepository(self.database)
        self.metrics = Metrics(lambda: (self.jobs.counts(), self.jobs.workers_alive()))


def services(request: Request) -> Services:
    """The services of the application that serves this request."""
    found: Services = request.app.state.services
    return found


def attach(app: FastAPI, found: Services) -> None:
    """Give an application its services."""
    app.state.services = found

"""The application: routes, problem documents, limits, metrics, and the store for as long as it lives."""

from __future__ import annotations

import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib.metadata import version
from typing import TYPE_CHECKING

from fastapi import FastAPI
from fastapi.routing import APIRoute

from safestart.errors import Unavailable
from safestart.settings import Settings
from safestart.settings import settings as process_settings
from safestart_service import openapi, problems
from safestart_service.limits import Limits
from safestart_service.metrics import MetricsMiddleware
from safestart_service.routes import (
    certificates,
    dashboard,
    events,
    go_no_go,
    jobs,
    landing,
    operations,
    processes,
    results,
)
from safestart_service.state import Services, attach

if TYPE_CHECKING:
    from safestart.store.database import Database

TITLE = "safestart"
DESCRIPTION = (
    "May a chaser start its approach to a tumbling target? Instant closed-form certificates, and a queue of "
    "reachability engines that check them. OGC API - Processes 1.0; every error is an RFC 9457 problem document."
)

log = logging.getLogger("safestart.service")


def create_app(settings: Settings | None = None, database: Database | None = None) -> FastAPI:
    """Build the application.

    Without ``database`` it opens and migrates the one of the settings; one that is away at start is reported by
    ``/readyz``, and the instant answers work all the same. Raises ``InvalidInput`` for a URL that is none.
    """
    found = Services(settings or process_settings(), database)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        if database is None:
            try:
                found.database.migrate()
            except Unavailable as error:
                log.error("%s", error.detail)
        yield
        found.database.close()

    app = FastAPI(
        title=TITLE,
        version=version("safestart-service"),
        description=DESCRIPTION,
        lifespan=lifespan,
        openapi_url=None,
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
    )
    attach(app, found)
    problems.install(app)
    openapi.install(app)
    app.add_middleware(MetricsMiddleware, metrics=found.metrics)
    app.add_middleware(Limits, max_body_bytes=found.settings.max_body_bytes)
    # Routes are tried in order, and an included router costs more than a route: the instant verdict comes first.
    app.router.routes.extend(go_no_go.one.routes)
    groups = (
        go_no_go.many,
        certificates.router,
        processes.router,
        jobs.router,
        results.router,
        events.router,
        landing.router,
        operations.router,
        dashboard.router,
    )
    for group in groups:
        app.include_router(group)
    routes = [
        route for group in (go_no_go.one, *groups) for route in group.routes if isinstance(route, APIRoute)
    ]
    app.state.route_table = [(route.path_regex, route.methods) for route in routes]
    return app

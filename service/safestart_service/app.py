"""The application: routes, problem documents, limits, metrics, and the store during its lifetime."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib.metadata import version
from typing import TYPE_CHECKING

from fastapi import FastAPI
from fastapi.routing import APIRoute

from safestart.errors import Unavailable
from safestart.runtime.settings import Settings
from safestart.runtime.settings import settings as process_settings
from safestart_service.access.proxies import Proxies
from safestart_service.computing.helpers.sources import Source
from safestart_service.documents import deprecation, openapi, problems
from safestart_service.http.limits import Limits
from safestart_service.metrics import MetricsMiddleware
from safestart_service.routes import (
    admin,
    certificates,
    dashboard,
    events,
    go_no_go,
    jobs,
    landing,
    operations,
    processes,
    provenance,
    results,
)
from safestart_service.shortage import shortage
from safestart_service.state import Services, attach

if TYPE_CHECKING:
    from safestart.store.database import Database

TITLE = "safestart"
DESCRIPTION = (
    "May a chaser start its approach to a tumbling target? No GO without a proof, in microseconds where a "
    "certificate in closed form decides, and a queue of "
    "reachability engines that check them. OGC API - Processes 1.0; every error is an RFC 9457 problem document."
)

log = logging.getLogger("safestart.service")
# Time between retries while the database is unavailable.
AWAY_S = 2.0


def create_app(
    settings: Settings | None = None,
    database: Database | None = None,
    *,
    warm: bool = False,
    source: Source | None = None,
) -> FastAPI:
    """Build the application.

    Without ``database`` it opens the one of the settings. It migrates the database at start. While the database is
    unavailable, or the machine has no room to ask it, ``/readyz`` reports it and instant answers work; the migration
    follows later. Raises ``InvalidInput`` for an invalid URL. ``warm`` starts a helper process before the first heavy
    answer; ``source``: where helper processes come from.
    """
    found = Services(settings or process_settings(), database, source)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        found.open()
        waiting = None
        if not await _migrated(found):
            waiting = asyncio.create_task(_keep_migrating(found))
        warming = found.helpers.warm() if warm else None
        async with found.keyring.kept_fresh():
            yield
        for task in (waiting, warming):
            if task is not None:
                task.cancel()
        found.close()

    app = FastAPI(
        title=TITLE,
        version=version("safestart-service"),
        description=DESCRIPTION,
        license_info={"name": "Apache-2.0", "url": "https://www.apache.org/licenses/LICENSE-2.0"},
        lifespan=lifespan,
        openapi_url=None,
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
    )
    attach(app, found)
    problems.install(app)
    openapi.install(app)
    # Routes are tried in order and an included router costs more than a route, so the instant verdict comes first.
    app.router.routes.extend(go_no_go.one.routes)
    groups = (
        go_no_go.proof,
        go_no_go.many,
        certificates.router,
        processes.router,
        jobs.router,
        results.router,
        provenance.router,
        events.router,
        landing.router,
        operations.router,
        admin.router,
        dashboard.router,
    )
    for group in groups:
        app.include_router(group)
    routes = [
        route for group in (go_no_go.one, *groups) for route in group.routes if isinstance(route, APIRoute)
    ]
    app.state.route_table = [(route.path_regex, route.methods) for route in routes]
    if deprecation.NOTICES:  # it would slow every answer down
        app.add_middleware(deprecation.Deprecation)
    app.add_middleware(MetricsMiddleware, metrics=found.metrics)
    app.add_middleware(
        Limits,
        max_body_bytes=found.settings.max_body_bytes,
        access=found.access,
        timeout_s=found.settings.request_timeout_s,
        max_bodies_bytes=found.settings.max_bodies_bytes,
        refused=found.metrics.refused,
        proxies=Proxies(found.settings, found.access.hosts, {route.path.split("/")[1] for route in routes}),
    )
    return app


async def _migrated(found: Services) -> bool:
    try:
        await asyncio.to_thread(found.database.migrate)
    except Exception as error:
        refused = error if isinstance(error, Unavailable) else shortage(error)
        if refused is None:
            raise
        log.error("%s", refused.detail)
        return False
    return True


async def _keep_migrating(found: Services) -> None:
    while True:
        await asyncio.sleep(AWAY_S)
        if await _migrated(found):
            log.info("the database is there")
            return

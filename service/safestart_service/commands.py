"""``safestart serve``: start the HTTP service on this machine."""

from __future__ import annotations

import gc
import ipaddress
import os
import socket
from contextlib import suppress
from functools import partial
from time import sleep
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from safestart.errors import Away, InvalidInput, SafestartError, Unavailable
from safestart.runtime.logs import configure, legible
from safestart_service.computing.allocator import keep_little
from safestart_service.http.open_files import make_room
from safestart_service.http.places import Places

if TYPE_CHECKING:
    from safestart.runtime.settings import Settings

REMEDY = (
    "anyone could use it, as no API keys are in force: make one with `safestart keys create --name NAME "
    "--role admin`, or bind to 127.0.0.1 or ::1"
)

AWAY_S = 2.0


def register(app: typer.Typer) -> None:
    """Add our command to the command group."""
    app.command("serve")(serve)


def serve(
    host: Annotated[
        str | None, typer.Option(help="Address to bind to; beyond loopback only with API keys.")
    ] = None,
    port: Annotated[int | None, typer.Option(min=0, max=65535, help="Port; 0: any free one.")] = None,
    database_url: Annotated[str | None, typer.Option(help="SQLAlchemy URL of the database.")] = None,
) -> None:
    """Serve the HTTP API and the dashboard."""
    given = {"host": host, "port": port, "database_url": database_url}
    try:
        _serve({name: value for name, value in given.items() if value is not None})
    except SafestartError as error:
        typer.echo(f"safestart serve: {legible(error.detail)}", err=True)
        raise typer.Exit(2) from None


def _serve(overrides: dict[str, object]) -> None:
    # Imported here, so that every other command starts without it.
    from safestart.runtime.settings import settings

    chosen = settings().model_copy(update=overrides)
    family, address = resolve(chosen.host, chosen.port)
    while not is_loopback(address):
        try:
            require_keys(chosen)
            break
        except Away as error:
            typer.echo(f"safestart: waits for the database: {legible(error.detail)}", err=True)
            sleep(AWAY_S)
    make_room(chosen.max_connections)
    # Helper processes compute one answer each; a pool of threads in every one of them would only take memory.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    keep_little()
    listener = listen(family, address, chosen.host)
    source = None
    try:
        # Imported only now, so that a wrong argument is answered at once.
        import uvicorn

        from safestart.store.database import Database
        from safestart_service.app import create_app
        from safestart_service.computing.helpers.early import forked
        from safestart_service.http.wire import Protocol

        configure(chosen.log_format)
        source = forked([listener])  # before there are threads and connections to a database
        database = Database(chosen.url())
        with suppress(Away):  # the application waits for it and reports that
            database.migrate()
        app = create_app(chosen, database, warm=True, source=source)
        refused = app.state.services.metrics.refused
        config = uvicorn.Config(
            app,
            http=cast(Any, partial(Protocol, places=Places(chosen.max_connections), refused=refused)),
            ws="none",
            access_log=False,
            log_config=None,
            log_level="error",  # our own messages about a peer's mistakes are enough
            server_header=False,
            proxy_headers=False,  # access/proxies.py reads them
            timeout_graceful_shutdown=3,  # event streams do not end by themselves
        )

        class Server(uvicorn.Server):
            async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
                app.state.services.helpers.leave()  # else its answers would be cut off when the grace is over
                await super().shutdown(sockets)

        server = Server(config)
        # Exclude the loaded objects from collection: a full collection would scan them all and delay every answer.
        gc.collect()
        gc.freeze()
        shown = f"[{chosen.host}]" if ":" in chosen.host else chosen.host
        base = f"http://{shown}:{listener.getsockname()[1]}{chosen.root_path}"
        # The socket listens already: new connections are answered as soon as the loop runs.
        typer.echo(f"safestart: {base} (dashboard {base}/dashboard, calls {base}/docs)")
        if not is_loopback(address):
            typer.echo("safestart: plain HTTP does not protect keys; put TLS in front of it", err=True)
        server.run(sockets=[listener])
    finally:
        listener.close()
        if source is not None:
            source.close()


def resolve(host: str, port: int) -> tuple[int, Any]:
    """Family and address to bind to; raises ``InvalidInput``."""
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    except OSError:
        raise InvalidInput(
            f"host: required an address of this machine, received {host!r}",
            field="host",
            required="an address of this machine",
        ) from None
    return family, address


def is_loopback(address: Any) -> bool:
    """True when only this machine can reach the address."""
    return ipaddress.ip_address(address[0].partition("%")[0]).is_loopback


def require_keys(chosen: Settings) -> None:
    """Raise ``InvalidInput`` unless an API key is in force, and ``Unavailable`` when the database does not answer."""
    from safestart.store.access.keys import KeyRepository
    from safestart.store.database import Database

    database, host = Database(chosen.url()), chosen.host
    try:
        database.migrate()
        found = KeyRepository(database).list()
    finally:
        database.close()
    if not any(key.usable for key in found):
        raise InvalidInput(
            f"host: required a loopback address, received {host}; {REMEDY}",
            field="host",
            required="a loopback address, or API keys",
            received=host,
        )


def listen(family: int, address: Any, host: str) -> socket.socket:
    """A listening socket; raises ``Unavailable``."""
    listener = socket.socket(family, socket.SOCK_STREAM)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen(2048)
    except OSError as error:
        listener.close()
        port = address[1]
        raise Unavailable(
            f"port: {host}:{port} cannot be bound ({error.strerror}); another port is chosen with --port, any free one "
            "with --port 0",
            field="port",
            required="a free port",
            received=port,
        ) from None
    return listener

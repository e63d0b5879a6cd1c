"""``safestart serve``: start the HTTP service on this machine."""

from __future__ import annotations

import ipaddress
import socket
from typing import Annotated

import typer

from safestart.errors import InvalidInput, SafestartError, Unavailable
from safestart.settings import settings

REMEDY = (
    "bind to 127.0.0.1 or ::1 and let a reverse proxy or an SSH tunnel on this machine face the network; the service "
    "has no API keys yet, so whoever reaches it may use it"
)


def register(app: typer.Typer) -> None:
    """Add our command to the command group."""
    app.command("serve")(serve)


def serve(
    host: Annotated[str | None, typer.Option(help="Loopback address to bind to.")] = None,
    port: Annotated[int | None, typer.Option(min=0, max=65535, help="Port; 0: any free one.")] = None,
    database_url: Annotated[str | None, typer.Option(help="SQLAlchemy URL of the database.")] = None,
) -> None:
    """Serve the HTTP API and the dashboard, on this machine only."""
    given = {"host": host, "port": port, "database_url": database_url}
    try:
        _serve({name: value for name, value in given.items() if value is not None})
    except SafestartError as error:
        typer.echo(f"safestart serve: {error.detail}", err=True)
        raise typer.Exit(2) from None


def _serve(overrides: dict[str, object]) -> None:
    chosen = settings().model_copy(update=overrides)
    listener = listen(chosen.host, chosen.port)
    try:
        # Imported when it is sure that they are needed: a wrong argument is answered at once.
        import uvicorn

        from safestart.store.database import Database
        from safestart_service.app import create_app

        database = Database(chosen.url())
        database.migrate()
        config = uvicorn.Config(
            create_app(chosen, database),
            http="httptools",
            access_log=False,
            log_level="warning",
            server_header=False,
            timeout_graceful_shutdown=3,  # event streams never end by themselves
        )
        server = uvicorn.Server(config)
        shown = f"[{chosen.host}]" if ":" in chosen.host else chosen.host
        base = f"http://{shown}:{listener.getsockname()[1]}"
        # The socket listens already: what connects from here on is answered as soon as the loop runs.
        typer.echo(f"safestart: {base} (dashboard {base}/dashboard, calls {base}/docs)")
        server.run(sockets=[listener])
    finally:
        listener.close()


def listen(host: str, port: int) -> socket.socket:
    """A listening socket on a loopback address; raises ``InvalidInput`` or ``Unavailable``."""
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    except OSError:
        raise InvalidInput(
            f"host: required a loopback address, received {host!r}",
            field="host",
            required="a loopback address",
        ) from None
    if not ipaddress.ip_address(address[0].partition("%")[0]).is_loopback:
        raise InvalidInput(
            f"host: required a loopback address, received {host}; {REMEDY}",
            field="host",
            required="a loopback address",
            received=host,
        )
    listener = socket.socket(family, socket.SOCK_STREAM)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen(2048)
    except OSError as error:
        listener.close()
        raise Unavailable(
            f"port: {host}:{port} cannot be bound ({error.strerror}); another port is chosen with --port, any free one "
            "with --port 0",
            field="port",
            required="a free port",
            received=port,
        ) from None
    return listener

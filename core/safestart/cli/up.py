"""``safestart up``: database, service, worker and cluster in one process tree."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from safestart.cli.console import err


def register(app: typer.Typer) -> None:
    """Add the command."""

    @app.command("up")
    def up(
        host: Annotated[str | None, typer.Option(help="Address to bind to; absent: the setting.")] = None,
        port: Annotated[
            int | None, typer.Option(min=0, max=65535, help="Port to bind to; absent: the setting.")
        ] = None,
    ) -> None:
        """Start everything on this machine and keep it running; Ctrl-C stops every part."""
        from safestart.runtime.children.supervise import Child, Supervisor
        from safestart.runtime.settings import settings

        configured = settings()
        host = host or configured.host
        port = configured.port if port is None else port
        command = [sys.executable, "-m", "safestart"]
        children = [
            Child("service", [*command, "serve", "--host", host, "--port", str(port)]),
            Child("worker", [*command, "worker"]),
        ]
        err.print(
            f"safestart: dashboard at http://{host}:{port}/dashboard (Ctrl-C stops everything)",
        )
        raise typer.Exit(Supervisor(children).run())

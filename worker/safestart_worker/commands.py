"""``safestart worker``; an entry point adds it to the command line."""

from __future__ import annotations

import asyncio
from typing import Annotated

import typer

from safestart.errors import invalid
from safestart.runtime.logs import configure
from safestart_worker.cluster.own_files import import_dask


def register(app: typer.Typer) -> None:
    """Add the command."""

    @app.command("worker")
    def worker(
        scheduler: Annotated[
            str, typer.Option(help="Address of a Dask scheduler; empty: the setting, or an embedded cluster.")
        ] = "",
        database_url: Annotated[str, typer.Option(help="SQLAlchemy URL; empty: the setting.")] = "",
        processes: Annotated[int, typer.Option(min=0, max=1024, help="Jobs at once; 0: the setting.")] = 0,
    ) -> None:
        """Claim jobs and run them on Dask until SIGTERM or Ctrl-C; running jobs then go back to the queue."""
        # Imported here, so that every other command starts without settings and Dask.
        from safestart.runtime.settings import settings

        configured = settings()
        address = scheduler or configured.scheduler
        try:
            if not address:  # what the user says about connections holds for the user's scheduler only
                import_dask()
            from safestart_worker.loop import Options, work
        except ValueError as error:  # Dask reads its files when it is imported
            raise invalid("dask", "configuration files in YAML", " ".join(str(error).split())) from None
        configure(configured.log_format)
        options = Options(
            database_url=database_url or configured.url(),
            scheduler=address,
            # On an existing cluster the cluster's size is the default limit.
            processes=processes or (0 if address else configured.processes),
            lease_s=configured.lease_s,
            poll_s=configured.poll_s,
            max_attempts=configured.max_attempts,
            silence_s=configured.silence_s,
            keep_s=configured.keep_days * 86_400.0,
            warm_up=configured.warm_up,
        )
        raise typer.Exit(asyncio.run(work(options)))

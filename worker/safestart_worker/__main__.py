"""``python -m safestart_worker``: the worker command alone."""

from __future__ import annotations

import typer

from safestart.cli.streams import run_command
from safestart_worker.commands import register

if __name__ == "__main__":
    app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    register(app)
    run_command(app)

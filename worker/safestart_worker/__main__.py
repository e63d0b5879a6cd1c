"""``python -m safestart_worker``: the worker command alone."""

from __future__ import annotations

import sys

import typer

from safestart.errors import SafestartError
from safestart_worker.commands import register

if __name__ == "__main__":
    app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    register(app)
    try:
        app()
    except SafestartError as error:
        sys.stderr.write(f"safestart: {error.detail}\n")
        sys.exit(2)

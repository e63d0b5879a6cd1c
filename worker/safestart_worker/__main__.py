"""``python -m safestart_worker``: the worker command alone."""

from __future__ import annotations

import sys

import typer

from safestart.runtime.own_process import exit_code, own_configuration
from safestart_worker.commands import register

if __name__ == "__main__":
    own_configuration()
    app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    register(app)
    sys.exit(exit_code(app))

"""``python -m safestart_service``: the same as ``safestart serve``."""

from __future__ import annotations

import typer

from safestart.cli.streams import run_command
from safestart_service.commands import serve

if __name__ == "__main__":
    run_command(lambda: typer.run(serve))

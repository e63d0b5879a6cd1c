"""``python -m safestart_service``: the same as ``safestart serve``."""

from __future__ import annotations

import sys

import typer

from safestart.runtime.own_process import exit_code, own_configuration
from safestart_service.commands import serve

if __name__ == "__main__":
    own_configuration()
    sys.exit(exit_code(lambda: typer.run(serve)))

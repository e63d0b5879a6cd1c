"""``python -m safestart_service``: the same as ``safestart serve``."""

from __future__ import annotations

import typer

from safestart_service.commands import serve

if __name__ == "__main__":
    typer.run(serve)

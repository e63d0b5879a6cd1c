"""``safestart demo``: the command; what it does is in :mod:`safestart.cli.showcase`."""

from __future__ import annotations

import typer

from safestart.cli.console import Json


def register(app: typer.Typer) -> None:
    """Add the command."""

    @app.command("demo")
    def demo(as_json: Json = False) -> None:
        """Start everything, submit the Table 2 benchmarks over HTTP, follow them, print the table, stop."""
        # The HTTP client is loaded here and not with every command.
        from safestart.cli.showcase import demonstrate

        demonstrate(as_json)

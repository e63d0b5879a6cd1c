"""The command ``safestart demo``; :mod:`safestart.cli.showcase` does the work."""

from __future__ import annotations

import typer

from safestart.cli.console import Json


def register(app: typer.Typer) -> None:
    """Add the command."""

    @app.command("demo")
    def demo(as_json: Json = False) -> None:
        """Start everything, submit the Table 2 benchmarks over HTTP, follow them, print the table, stop."""
        # Imported here, so that other commands do not load the HTTP client.
        from safestart.cli.showcase import demonstrate

        demonstrate(as_json)

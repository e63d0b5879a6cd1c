"""The command line: ``safestart``. Service and worker add their commands by the entry-point group below."""

from __future__ import annotations

import os
import sys
from importlib import import_module

import typer

from safestart.cli.streams import run_command
from safestart.cli.strict import strictly
from safestart.runtime.variables import require_known

COMMAND_GROUP = "safestart.commands"
# The modules of our commands in the order of the help, each with the commands that it adds.
COMMANDS = {
    "up": ("up",),
    "go_no_go": ("go-no-go",),
    "field.timeline": ("timeline",),
    "field.convert": ("convert",),
    "run": ("run",),
    "reproduce.command": ("reproduce",),
    "demo": ("demo",),
    "bench": ("bench",),
    "verify": ("verify",),
    "records": ("replay", "label", "export", "import", "backup", "restore", "purge"),
    "keys": ("keys",),
    "aboard.export_c": ("export-c",),
}


def build(asked: str = "") -> typer.Typer:
    """The application with every installed distribution's commands; with ours alone that is ``asked``, if there is one.

    The modules of all commands take longer to load than a verdict takes to give.
    """
    app = typer.Typer(
        name="safestart",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
    )

    @app.callback()
    def safestart() -> None:
        """May this chaser start its approach to that tumbling target?"""
        require_known(os.environ)

    wanted = [name for name, commands in COMMANDS.items() if asked in commands]
    for name in wanted or COMMANDS:
        import_module(f"safestart.cli.{name}").register(app)
    if not wanted:
        from importlib.metadata import entry_points

        for point in sorted(entry_points(group=COMMAND_GROUP), key=lambda p: p.name):
            point.load()(app)
    strictly(app)
    return app


def main() -> None:
    """Run the command line; our own errors, and missing or full places, end it with one line and exit code 2."""
    run_command(lambda: build(*sys.argv[1:2])())

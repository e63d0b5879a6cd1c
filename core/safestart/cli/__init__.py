"""The command line: ``safestart``. Service and worker add their commands by the entry-point group below."""

from __future__ import annotations

import os
import sys
from importlib import import_module
from typing import TYPE_CHECKING

import typer

from safestart.cli.streams import run_command
from safestart.cli.strict import strictly
from safestart.errors import Misregistered
from safestart.runtime.logs import legible
from safestart.runtime.variables import require_known

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

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
    """The application with every installed distribution's commands, or with the one that is ``asked``, if it exists.

    The modules of all commands take longer to load than a verdict takes to give, and NumPy, which some of them load,
    starts threads before a service has said how many it wants. An entry point has the name of its command.
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
    points: list[EntryPoint] = []
    if not wanted:
        from importlib.metadata import entry_points

        points = sorted(entry_points(group=COMMAND_GROUP), key=lambda point: point.name)
        named = [point for point in points if point.name == asked]
        wanted, points = ([], named) if named else (list(COMMANDS), points)
    for name in wanted:
        import_module(f"safestart.cli.{name}").register(app)
    for point in points:
        _add(point, app, alone=len(points) == 1)
    strictly(app)
    return app


def _add(point: EntryPoint, app: typer.Typer, *, alone: bool) -> None:
    """Add the command of another distribution; one that is broken is named, and raises only where it is asked for."""
    try:
        point.load()(app)
    except Exception as error:  # whatever a module does
        whose = point.value if point.dist is None else f"{point.dist.name} {point.dist.version}"
        required = f"the command {point.name} of {whose} to load"
        refusal = Misregistered(
            f"required {required}, received {type(error).__name__}: {error}", required=required
        )
        if alone:
            raise refusal from error
        sys.stderr.write(f"safestart: {legible(refusal.detail)}\n")


def main() -> None:
    """Run the command line; our own errors, and missing or full places, end it with one line and exit code 2."""
    run_command(lambda: build(*sys.argv[1:2])())

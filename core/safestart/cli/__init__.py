"""The command line: ``safestart``. Service and worker add their commands by the entry-point group below."""

from __future__ import annotations

import sys
from importlib.metadata import entry_points

import typer

from safestart.cli import bench, demo, go_no_go, keys, records, run, up, verify
from safestart.cli.aboard import export_c
from safestart.cli.field import convert, timeline
from safestart.cli.reproduce import command as reproduce
from safestart.cli.streams import patient_streams
from safestart.runtime.own_process import exit_code, own_configuration

COMMAND_GROUP = "safestart.commands"


def build() -> typer.Typer:
    """The application with every installed distribution's commands."""
    app = typer.Typer(
        name="safestart",
        help="May this chaser start its approach to that tumbling target?",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
    )
    for module in (
        up,
        go_no_go,
        timeline,
        convert,
        run,
        reproduce,
        demo,
        bench,
        verify,
        records,
        keys,
        export_c,
    ):
        module.register(app)
    for point in sorted(entry_points(group=COMMAND_GROUP), key=lambda p: p.name):
        point.load()(app)
    return app


def main() -> None:
    """Run the command line; our own errors, and missing or full places, end it with one line and exit code 2."""
    own_configuration()
    with patient_streams() as streams:
        code = streams.code(exit_code(lambda: build()()))
    sys.exit(code)

"""``safestart run PROCESS``: any process, in this process, with a progress bar."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from safestart.cli.console import Json, err, print_json, reporting
from safestart.cli.files import read_json, target
from safestart.processes.execute import execute
from safestart.processes.registry import PROCESS_IDS, process


def register(app: typer.Typer) -> None:
    """Add the command."""

    @app.command("run")
    def run(
        process_id: Annotated[
            str, typer.Argument(metavar="PROCESS", help=f"One of: {', '.join(PROCESS_IDS)}.")
        ],
        input_file: Annotated[
            str,
            typer.Option(
                "--input", help="JSON file with the inputs; '-' reads stdin; absent: every default."
            ),
        ] = "",
        output_file: Annotated[
            Path | None,
            typer.Option("--output", help="Where to write the document; artifacts (PNG, NPZ) go beside it."),
        ] = None,
        as_json: Json = False,
    ) -> None:
        """Run a process here and write {"inputs", "outputs", "provenance"}, with its pictures beside it."""
        spec = process(process_id)
        inputs = {} if not input_file else read_json("--input", input_file)
        parsed = spec.parse(inputs)
        with target("--output", output_file) as file:
            with reporting(process_id) as context:
                result = execute(process_id, parsed, context)
            for note in result.document["provenance"].get("notes", ()):
                err.print(note, soft_wrap=True, markup=False)
            if file is not None:
                file.write_json(result.document, indent=2)
                for artifact in result.artifacts:
                    file.write_beside(artifact.name, artifact.data)
        for item in file.written if file is not None else ():
            err.print(f"wrote {item}", soft_wrap=True, markup=False)
        if as_json or output_file is None:
            print_json(result.document)

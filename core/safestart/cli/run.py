"""``safestart run PROCESS``: any process, in this process, with a progress bar."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from safestart.cli.console import Json, err, print_json, reporting
from safestart.cli.files import Target, readable, target, writable
from safestart.errors import InvalidInput, invalid
from safestart.processes.execute import Execution, execute
from safestart.processes.registry import PROCESS_IDS, process
from safestart.runtime.plain_json import NameTwice, loads


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
        inputs = _read(input_file)
        spec.parse(inputs)
        with target("--output", output_file) as file:
            with reporting(process_id) as context:
                result = execute(process_id, inputs, context)
            for note in result.document["provenance"].get("notes", ()):
                err.print(note, soft_wrap=True, markup=False)
            if file is not None:
                _write(file, result)
        if as_json or output_file is None:
            print_json(result.document)


def _read(source: str) -> Any:
    if not source:
        return {}
    try:
        with readable("--input", source):
            text = sys.stdin.read() if source == "-" else Path(source).read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise invalid("--input", "UTF-8 text", source) from None
    try:
        return loads(text)
    except NameTwice as error:
        raise invalid("--input", "JSON with every name once in an object", str(error)) from None
    except (ValueError, RecursionError) as error:
        raise InvalidInput(f"--input: required JSON, received text that is not ({error})") from None


def _write(file: Target, result: Execution) -> None:
    file.write_json(result.document, indent=2)
    written = [file.path]
    for artifact in result.artifacts:
        written.append(file.path.with_name(f"{file.path.stem}.{artifact.name}"))
        with writable("--output", written[-1]):
            written[-1].write_bytes(artifact.data)
    for item in written:
        err.print(f"wrote {item}", soft_wrap=True, markup=False)

"""``safestart go-no-go``: one start, one verdict."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from safestart.cli.console import Json, out, print_json
from safestart.cli.files import read_json, target
from safestart.cli.options import takes
from safestart.errors import invalid
from safestart.processes.door import PARAMETERS, parse
from safestart.processes.execute import execute
from safestart.processes.registry import process
from safestart.runtime.progress import Context


def register(app: typer.Typer) -> None:
    """Add the command."""

    @app.command("go-no-go")
    @takes(PARAMETERS, without=("proofs",))
    def go_no_go(
        *,
        input_file: Annotated[
            str,
            typer.Option(
                "--input",
                help="JSON file with these inputs, or with those of a POST (states, starts); '-' reads stdin. An "
                "option replaces the file's value.",
            ),
        ] = "",
        proof: Annotated[
            Path | None,
            typer.Option(help="Where to write the proof (method exact, auto), for `safestart verify`."),
        ] = None,
        as_json: Json = False,
        **asked: Any,
    ) -> None:
        """May a chaser that is at rest here, or arrives like this, start its approach? Every GO has a proof, except
        those of method paper."""
        given = {
            name: PARAMETERS[name].value(name, value) for name, value in asked.items() if value is not None
        }
        if input_file:
            given = _read(input_file) | given
        for name, process_id in (("states", "go-no-go"), ("starts", "start-in-space")):
            if name in given:
                _many(process_id, given, proof, as_json=as_json)
                return
        asked_for = parse(given | ({"proofs": True} if proof is not None else {}))
        with target("--proof", proof) as file:
            document = asked_for.document(Context())
            if file is not None:
                file.write_json(_proved(document["proof"]))
        if as_json:
            print_json(document)
            return
        _say(document["verdict"], document["reason"])
        for line in asked_for.remarks(document):
            out.print(f"  {escape(line)}", soft_wrap=True)


def _read(source: str) -> dict[str, Any]:
    given = read_json("--input", source)
    if not isinstance(given, dict):
        raise invalid("--input", "a JSON object of inputs", type(given).__name__)
    return given


def _many(process_id: str, given: dict[str, Any], proof: Path | None, *, as_json: bool) -> None:
    """Answer a body of several starts, as POST does: one line for each."""
    inputs = process(process_id).parse(given | ({"proofs": True} if proof is not None else {}))
    with target("--proof", proof) as file:
        document = execute(process_id, inputs, Context()).document["outputs"]
        if file is not None:
            if len(document["proof"]) != 1:
                raise invalid("--proof", "one start", len(document["proof"]))
            file.write_json(_proved(document["proof"][0]))
    if as_json:
        print_json(document)
        return
    for verdict, reason in zip(document["verdict"], document["reason"], strict=True):
        _say(verdict, reason)


def _say(verdict: str, reason: str) -> None:
    out.print(f"[bold {'green' if verdict == 'GO' else 'red'}]{verdict}[/]: {escape(reason)}", soft_wrap=True)


def _proved(document: object) -> object:
    if document is None:
        raise invalid("--proof", "a proved verdict (method exact, GO or NO_GO)", "none")
    return document

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
from safestart.processes.door import PARAMETERS, document_of_one, parse
from safestart.processes.execute import execute
from safestart.processes.registry import process
from safestart.processes.start_in_space.spec import SpaceInputs
from safestart.runtime.progress import Context

_BY = {
    "certified": "the certificate in closed form (docs/theory/certified.md)",
    "exact": "a cone program",
    "atlas": "an atlas of cone programs",
    "families": "cone programs for all members",
    "tube": "a cone program in the tightened corridor",
    "paper": "the paper's conditions; this proves nothing",
}


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
                help="JSON file with these inputs, or with those of a POST (states, starts); '-' reads stdin. Options "
                "stand over it.",
            ),
        ] = "",
        proof: Annotated[
            Path | None,
            typer.Option(help="Where to write the proof (method exact, auto), for `safestart verify`."),
        ] = None,
        as_json: Json = False,
        **asked: Any,
    ) -> None:
        """May a chaser that is at rest here, or arrives like this, start its approach? No GO without a proof, but by
        method paper."""
        given = {name: value for name, value in asked.items() if value is not None}
        if input_file:
            given = _read(input_file) | given
        for name, process_id in (("states", "go-no-go"), ("starts", "start-in-space")):
            if name in given:
                _many(process_id, given, proof, as_json=as_json)
                return
        inputs = parse(given | ({"proofs": True} if proof is not None else {}))
        with target("--proof", proof) as file:
            document = document_of_one(inputs, Context())
            if file is not None:
                file.write_json(_proved(document["proof"]))
        if as_json:
            print_json(document)
        elif isinstance(inputs, SpaceInputs):
            _say(document["verdict"], document["reason"])
        else:
            _show(document)


def _read(source: str) -> dict[str, Any]:
    given = read_json("--input", source)
    if not isinstance(given, dict):
        raise invalid("--input", "a JSON object of inputs", type(given).__name__)
    return given


def _many(process_id: str, given: dict[str, Any], proof: Path | None, *, as_json: bool) -> None:
    """Answer a body of several starts, as POST does: one line for each."""
    inputs = process(process_id).parse(given | ({"proofs": True} if proof is not None else {}))
    with target("--proof", proof) as file:
        document = execute(process_id, inputs.model_dump(mode="json"), Context()).document["outputs"]
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


def _show(document: dict[str, Any]) -> None:
    """Print the verdict on the one start, why, what decided, and what the paper's conditions say of it."""
    _say(document["verdict"], document["reason"])
    for member in document["examples"] or ():
        out.print(f"  {_told(member)}", soft_wrap=True)
    if document["decided_by"] is not None:
        out.print(f"  decided by: {_BY.get(document['decided_by'], document['decided_by'])}")
    r_sync = document["r_sync_m"]
    shown = f"{r_sync:.2f} m" if r_sync is not None else f"none ({document['r_sync_reason']})"
    out.print("  beside it the paper's conditions, which are not sound:")
    out.print(f"  synchronization range limit: {shown}")
    for face, margin in document["face_margins_m"].items():
        out.print(f"  margin after erosion {face:<11} {margin:9.2f} m")


def _told(member: dict[str, Any]) -> str:
    """One line for one member of the sets."""
    margin = member["margin_m"]
    return (
        f"{member['verdict']} for {member['omega_t_deg_s']:.6g} deg/s, {member['a_max_m_s2']:g} m/s^2, "
        f"{member['mean_motion_rad_s']:g} rad/s, start (LVLH) {member['position_m']} m, {member['velocity_m_s']} m/s: "
        f"margin {'-' if margin is None else format(margin, '.3g')} m"
    )


def _proved(document: object) -> object:
    if document is None:
        raise invalid("--proof", "a proved verdict (method exact, GO or NO_GO)", "none")
    return document

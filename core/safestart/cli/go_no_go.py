"""``safestart go-no-go``: one start, one verdict."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from safestart.cli.console import Json, out, print_json
from safestart.cli.files import target
from safestart.cli.options import takes
from safestart.errors import invalid
from safestart.processes.go_no_go.one_start import ONE_START
from safestart.processes.go_no_go.run import answer
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
    @takes(ONE_START, without=("proofs",))
    def go_no_go(
        *,
        proof: Annotated[
            Path | None,
            typer.Option(help="Where to write the proof (method exact, auto), for `safestart verify`."),
        ] = None,
        as_json: Json = False,
        **asked: Any,
    ) -> None:
        """May a chaser at rest at this point start its approach? No GO without a proof, but by method paper."""
        given = {name: value for name, value in asked.items() if value is not None}
        inputs = ONE_START.parse(given | {"proofs": proof is not None})
        with target("--proof", proof) as file:
            document = answer(inputs, Context()).document_of_one()
            if file is not None:
                file.write_json(_proved(document["proof"]))
        print_json(document) if as_json else _show(document)


def _show(document: dict[str, Any]) -> None:
    """Print the verdict on the one start, why, what decided, and what the paper's conditions say of it."""
    verdict = document["verdict"]
    out.print(f"[bold {'green' if verdict == 'GO' else 'red'}]{verdict}[/]: {document['reason']}")
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

"""``safestart reproduce passive-safety``: the rows of the rendezvous competition (paper 003), ours beside theirs."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any, Literal

import typer

from safestart.cli.console import Json, Justify, number, out, print_json, reporting, seconds, table_of

NOTES = (
    "Half-width of the target's box: paper 003 and CORA take 0.1 m, other tools 0.2 m; at 0.1 m the rows SRU01 and "
    "SRU02, meant to be unsafe, are proved safe.",
    "velocity is the octagon of the competition; disc is the true limit of 5 cm/s, which starts that cross the "
    "octagonal guard far from the target break after the switch.",
    "Of a failure with nonlinear dynamics no verdict was published: C2E2 found none.",
    "Times: the published ones are from other machines. Ours leave out the tables of matrix exponentials, once per "
    "process.",
)

Model = Annotated[Literal["linear", "nonlinear"], typer.Option(help="Relative dynamics.")]
GuardName = Annotated[Literal["octagon", "circle"], typer.Option("--guard", help="Where mode 2 begins.")]

_COLUMNS: tuple[tuple[str, Justify], ...] = (
    ("case", "left"),
    ("box m", "right"),
    ("separation", "left"),
    ("published", "left"),
    ("distance m", "right"),
    ("thrust", "left"),
    ("LOS", "left"),
    ("velocity", "left"),
    ("disc", "left"),
    ("run", "right"),
    ("published", "right"),
)


def register(group: typer.Typer) -> None:
    """Add the command to the group ``reproduce``."""

    @group.command("passive-safety")
    def passive_safety(model: Model = "linear", guard: GuardName = "octagon", as_json: Json = False) -> None:
        """Paper 003 and its competition: rows SRNA01, SRA01-08, SRU01-02 at both half-widths, and the paper's job."""
        print_passive_safety(as_json, model, guard)


def print_passive_safety(as_json: bool = False, model: str = "linear", guard: str = "octagon") -> None:
    """Answer the question and print it beside the paper's figures."""
    document = passive_safety_document(model, guard)
    if as_json:
        print_json(document)
    else:
        show(document["rows"], document["paper"], f"{model} dynamics, {guard} guard")


def passive_safety_document(model: str = "linear", guard: str = "octagon") -> dict[str, Any]:
    """``rows`` of the competition, the ``paper``'s job, and ``notes``."""
    from safestart.passive_safety.competition import competition_rows, paper_row
    from safestart.passive_safety.model import Dynamics, System
    from safestart.passive_safety.switching_guard import Guard
    from safestart.passive_safety.warm import warm

    system = System(Dynamics(model), guard=Guard(guard))
    with reporting("passive safety") as context:
        warm(system)
        rows, paper = competition_rows(context, system), paper_row(system)
    return {"model": model, "guard": guard, "rows": rows, "paper": paper, "notes": list(NOTES)}


def show(rows: Iterable[dict[str, Any]], paper: dict[str, Any], what: str) -> None:
    """Print the rows and the paper's job."""
    table = table_of(f"Passive safety of the switched rendezvous (paper 003), T = 300 min, {what}", _COLUMNS)
    for row in rows:
        times = row["published"]["tools_s"]
        table.add_row(
            row["case"],
            f"{row['half_width_m']:g}",
            row["separation"],
            row["published"]["verdict"],
            number(row["distance_proved_m"]),
            row["thrust"],
            row["los"],
            row["velocity"],
            row["velocity_disc"],
            seconds(row["run_s"]),
            ", ".join(f"{tool} {_range(*ends)}" for tool, ends in times.items()) or "-",
        )
    out.print(table)
    out.print(
        f"paper's job (240 min, aborts in [120, 125] min, every requirement): {seconds(paper['run_s'])}; published: "
        "SDVTool 5.5 s, SpaceEx 6.2-6.5 s and C2E2 17.8-85 s per requirement"
    )
    for line in NOTES:
        out.print(f"- {line}")


def _range(least: float, most: float) -> str:
    return f"{least:g} s" if least == most else f"{least:g}-{most:g} s"

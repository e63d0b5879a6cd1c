"""``safestart reproduce passive-safety``: the rows of the rendezvous competition (paper 003), ours beside theirs."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import typer

from safestart.cli.console import Json, Justify, number, out, print_json, reporting, seconds, table_of

NOTES = (
    "Half-width of the target's box: paper 003 and CORA take 0.1 m, other tools 0.2 m; at 0.1 m the rows SRU01 and "
    "SRU02, meant to be unsafe, are proved safe.",
    "velocity is the octagon of the competition; disc is the true limit of 5 cm/s, which starts that cross the "
    "octagonal guard far from the target break after the switch.",
    "Times: the published ones are from other machines. Ours leave out the tables of matrix exponentials, once per "
    "process.",
)

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
    def passive_safety(as_json: Json = False) -> None:
        """Paper 003 and its competition: rows SRNA01, SRA01-08, SRU01-02 at both half-widths, and the paper's job."""
        print_passive_safety(as_json)


def print_passive_safety(as_json: bool = False) -> None:
    """What the command does."""
    document = passive_safety_document()
    if as_json:
        print_json(document)
    else:
        show(document["rows"], document["paper"])


def passive_safety_document() -> dict[str, Any]:
    """``rows`` of the competition, the ``paper``'s job, and ``notes``."""
    from safestart.verification.rows import competition_rows, paper_row, warm

    with reporting("passive safety") as context:
        warm()
        return {"rows": competition_rows(context), "paper": paper_row(), "notes": list(NOTES)}


def show(rows: Iterable[dict[str, Any]], paper: dict[str, Any]) -> None:
    """Print the rows and the paper's job."""
    table = table_of("Passive safety of the switched rendezvous (paper 003), T = 300 min", _COLUMNS)
    for row in rows:
        times = row["published"]["run_s"]
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
            "-" if times is None else "-".join(f"{t:g}" for t in sorted(set(times))) + " s",
        )
    out.print(table)
    out.print(
        f"paper's job (240 min, aborts in [120, 125] min, every requirement): {seconds(paper['run_s'])}; published: "
        "SDVTool 5.5 s, SpaceEx 6.2-6.5 s and C2E2 17.8-85 s per requirement"
    )
    for line in NOTES:
        out.print(f"- {line}")

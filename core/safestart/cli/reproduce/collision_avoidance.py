"""``safestart reproduce collision-avoidance``: the cases of paper 001, which prints no figures of its results."""

from __future__ import annotations

from typing import Any

import typer

from safestart.cli.console import Json, Justify, number, out, print_json, reporting, table_of
from safestart.processes.execute import execute

PAPER = "0.0011 rad/s, |u| 0.1, |d| 0.05 m/s^2 by axis, gains of Table I, slot at 1000 m"

_PILOTS: tuple[tuple[str, Justify], ...] = (
    ("pilot", "left"),
    ("adversary", "left"),
    ("lost", "right"),
    ("of", "right"),
    ("95 %", "right"),
    ("least m", "right"),
    ("m/s", "right"),
)


def register(group: typer.Typer) -> None:
    """Add the command to the group ``reproduce``."""

    @group.command("collision-avoidance")
    def collision_avoidance(as_json: Json = False) -> None:
        """Paper 001: its unsafe set, capture set, escape modes and encounters."""
        document = collision_avoidance_document()
        print_json(document) if as_json else show(document)


def collision_avoidance_document(inputs: dict[str, Any] | None = None) -> dict[str, Any]:
    """Inputs and outputs of the process at the paper's values (its defaults), except for ``inputs``."""
    with reporting("collision avoidance") as context:
        document = execute("collision-avoidance", inputs or {}, context).document
    return {"paper": PAPER, "inputs": document["inputs"], **document["outputs"]}


def show(document: dict[str, Any]) -> None:
    """Print verdicts, encounters, escapes and capture slices."""
    table = table_of(
        f"Paper 001: {PAPER}",
        (
            ("requirement", "left"),
            ("verdict", "left"),
            ("broken", "right"),
            ("of", "right"),
            ("95 %", "right"),
        ),
    )
    for row in document["requirements"]:
        table.add_row(
            row["requirement"], row["verdict"], str(row["broken"]), str(row["encounters"]), _interval(row, "")
        )
    out.print(table)
    table = table_of("Encounters from outside the unsafe set, near it", _PILOTS)
    for row in document["encounters"]:
        if row["starts"] == "outside":
            table.add_row(
                row["pilot"],
                row["adversary"],
                str(row["lost"]),
                str(row["encounters"]),
                _interval(row, "breach_"),
                number(row["least_separation_m"]),
                number(row["mean_delta_v_m_s"]),
            )
    out.print(table)
    table = table_of(
        "Escape modes: what the paper says, and the motion",
        (
            ("mode", "left"),
            ("paper", "left"),
            ("drift m/s", "right"),
            ("altitude m", "right"),
            ("back s", "right"),
        ),
    )
    for row in document["escape"]:
        table.add_row(
            row["mode"],
            row["paper_says"],
            f"{row['drift_m_s']:.1f}",
            f"{row['altitude_m']:.0f}",
            "-" if row["overtakes_s"] is None else f"{row['overtakes_s']:.0f}",
        )
    out.print(table)
    for row in document["capture"]:
        out.print(
            f"capture at radial speed {row['radial_m_s']:g} m/s: {row['captured_percent']:.1f} % of the positions drawn"
        )
    for line in document["notes"]:
        out.print(f"- {line}")


def _interval(row: dict[str, Any], prefix: str) -> str:
    low, high = row[f"{prefix}low"], row[f"{prefix}high"]
    return "-" if low is None else f"{100 * low:.2f}-{100 * high:.2f} %"

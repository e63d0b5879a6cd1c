"""``safestart reproduce table3``: which certified starts fly, ours beside the paper's, and the effect of single
causes."""

from __future__ import annotations

from typing import Any

import typer

from safestart.cli.console import Json, Justify, number, out, print_json, reporting, table_of
from safestart.papers import safe_start as published
from safestart.processes.execute import execute

NOTES = (
    "The paper prints no gains and no draw of its starts; ours are nine per cell at a random angle inside the "
    "corridor, 15 x 4 cells (the paper flew 500 of 540).",
    "filter, preset paper: its two weights, the rows it mentions, and a speed cap of sqrt(a_max r0). Only the closing "
    "speed explains the published false positives: with a cap that the braking distance can afford they are gone; "
    "thrust projection and inter-sample violation move precision by a few points.",
    "disk projection off delivers up to sqrt(2) a_max: it also flies starts that nothing certifies.",
    "sequence flies every start that the exact certificate admits; recall of the closed forms falls as the controller "
    "improves. Precision of 1 comes with its 95 % Wilson interval.",
    "Violations are looked for at all times unless the row says otherwise.",
)

CAUSES: tuple[tuple[str, dict[str, Any]], ...] = (
    ("none switched off", {}),
    ("checked at nodes only", {"truth": {"check": "nodes"}}),
    ("command every 0.5 s", {"controllers": ["filter_fine"]}),
    ("closing speed capped", {"filter": {"closing_factor": 0.6, "braking_share": 0.25}}),
    ("no disk projection", {"filter": {"disk_projection": False}}),
    ("move weight 0.2", {"filter": {"move_weight": 0.2}}),
)
# Starts per cell of the causes: enough to resolve a few points of precision.
CAUSE_CASES = 90


def register(group: typer.Typer) -> None:
    """Add the command to the group ``reproduce``."""

    @group.command("table3")
    def table3(as_json: Json = False) -> None:
        """Table 3: certified and flown starts, confusion matrices, and what the published false positives come from."""
        document = table3_document()
        print_json(document) if as_json else show(document)


def table3_document() -> dict[str, Any]:
    """``rows`` of the table, ``confusion`` by controller, ``causes``, ``notes``."""
    with reporting("table 3") as context:
        ours = execute("sweep", {}, context).document["outputs"]
        paper = execute("sweep", {"controllers": ["filter"], "preset": "paper"}).document["outputs"]
    causes = []
    with reporting("single causes") as context:
        for count, (name, change) in enumerate(CAUSES):
            inputs = {"controllers": ["filter"], "preset": "paper", "cases_per_cell": CAUSE_CASES, **change}
            inputs |= {"certificates": ["paper"], "worst": 0, "records": 0}
            found = execute("sweep", inputs).document["outputs"]["confusion"]["paper"]
            causes.append({"cause": name, **next(iter(found.values()))})
            context.step(count + 1, len(CAUSES), name)
    confusion = {
        "filter, tuned": {c: ours["confusion"][c]["filter"] for c in ours["confusion"]},
        "filter, paper": {c: paper["confusion"][c]["filter"] for c in paper["confusion"]},
        "sequence": {c: ours["confusion"][c]["sequence"] for c in ours["confusion"]},
    }
    rows = [_row(cell, flown) for cell, flown in zip(ours["cells"], paper["cells"], strict=True)]
    published_one = {"as printed": published.TABLE3_CONFUSION}
    return {
        "rows": rows,
        "confusion": confusion,
        "paper": published_one,
        "causes": causes,
        "notes": list(NOTES),
    }


def _row(cell: dict[str, Any], paper: dict[str, Any]) -> dict[str, Any]:
    printed = published.TABLE3[cell["a_max_m_s2"]].get(cell["omega_t_deg_s"])
    index = published.TABLE3_RANGES_M.index(cell["r0_m"])
    return {
        "a_max_m_s2": cell["a_max_m_s2"],
        "omega_t_deg_s": cell["omega_t_deg_s"],
        "r0_m": cell["r0_m"],
        "certified": cell["certified"],
        "feasible": {**cell["feasible"], "filter_paper": paper["feasible"]["filter"]},
        "paper": None if printed is None else list(printed[index]),
    }


def show(document: dict[str, Any]) -> None:
    """Print table, confusion matrices and causes."""
    columns: list[tuple[str, Justify]] = [("m/s²", "right"), ("deg/s", "right")]
    columns += [(f"{r:g} m", "right") for r in published.TABLE3_RANGES_M]
    table = table_of(
        "Table 3, of nine starts: certified / flown by the filter (paper gains) / by sequence (paper: certified/flown)",
        columns,
    )
    rows = document["rows"]
    width = len(published.TABLE3_RANGES_M)
    for first in range(0, len(rows), width):
        line = rows[first : first + width]
        table.add_row(
            f"{line[0]['a_max_m_s2']:g}", f"{line[0]['omega_t_deg_s']:g}", *(_cell(row) for row in line)
        )
    out.print(table)
    shown = ("TP", "FP", "FN", "TN", "precision", "95 %", "recall", "MCC")
    head: list[tuple[str, Justify]] = [("certificate", "left"), ("controller", "left")]
    matrices = table_of("Certified against flown", head + [(name, "right") for name in shown])
    for controller, by_certificate in document["confusion"].items():
        for certificate, cell in by_certificate.items():
            matrices.add_row(certificate.replace("_", " "), controller, *_figures(cell))
    matrices.add_row("paper", "as printed", *_figures(document["paper"]["as printed"]))
    out.print(matrices)
    causes = table_of(
        "Filter with the paper's gains, the paper's conditions: one cause at a time",
        [("cause", "left"), *((name, "right") for name in shown)],
    )
    for cell in document["causes"]:
        causes.add_row(cell["cause"], *_figures(cell))
    out.print(causes)
    for line in NOTES:
        out.print(f"- {line}")


def _cell(row: dict[str, Any]) -> str:
    ours = f"{row['certified']['paper']}/{row['feasible']['filter_paper']}/{row['feasible']['sequence']}"
    return f"{ours} ({'-' if row['paper'] is None else '/'.join(map(str, row['paper']))})"


def _figures(cell: dict[str, Any]) -> list[str]:
    interval = cell.get("wilson_95", {}).get("precision")
    return [
        *(str(cell[name]) for name in ("tp", "fp", "fn", "tn")),
        number(cell["precision"]),
        "" if interval is None else f"{interval[0]:.3f}-{interval[1]:.3f}",
        *(number(cell[name]) for name in ("recall", "mcc")),
    ]

"""``safestart reproduce chain``: the inclusions of eq. (12), claimed and found."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from safestart.cli.console import Json, Justify, number, out, print_json, reporting, table_of
from safestart.papers import safe_start as published
from safestart.processes.execute import execute
from safestart.processes.inclusion_chain.spec import ALL_SETS, CHAIN
from safestart.runtime.progress import Context

_COLUMNS: tuple[tuple[str, Justify], ...] = (
    ("deg/s", "right"),
    ("whose", "left"),
    ("claimed", "left"),
    ("cells", "right"),
    ("outside", "right"),
    ("share", "right"),
    ("counter-example", "left"),
)


def register(group: typer.Typer) -> None:
    """Add the command to the group ``reproduce``."""

    @group.command("chain")
    def chain(
        rate: Annotated[
            list[float] | None,
            typer.Option(help="Tumble rate, deg/s; repeatable. Absent: those of Table 2."),
        ] = None,
        level_sets: Annotated[
            bool, typer.Option(help="Leave out the level sets with --no-level-sets: seconds, not a minute.")
        ] = True,
        as_json: Json = False,
    ) -> None:
        """Eq. (12): S_tube in S_ana in S_sync in S_HJpos, at 0.10 m/s^2 and 40 s, and with the sound certificate."""
        document = chain_document(rate or list(published.TABLE2), level_sets=level_sets)
        print_json(document) if as_json else show(document)


def chain_document(rates: list[float], *, level_sets: bool = True) -> dict[str, Any]:
    """Outputs of ``inclusion-chain`` per tumble rate (deg/s), at the thrust of Table 2."""
    sets = [name for name in ALL_SETS if level_sets or not name.startswith("hj_")]
    points = []
    for rate in rates:
        with reporting(f"chain at {rate:g} deg/s") as context:
            inputs = {"omega_t_deg_s": rate, "a_max_m_s2": published.TABLE2_THRUST_M_S2, "sets": sets}
            outputs = execute("inclusion-chain", inputs, context).document["outputs"]
            late = _at_containment(inputs, outputs, context)
        points.append(
            {
                "omega_t_deg_s": rate,
                "a_max_m_s2": published.TABLE2_THRUST_M_S2,
                **outputs,
                "at_containment": late,
            }
        )
    return {"points": points}


def _at_containment(
    inputs: dict[str, Any], outputs: dict[str, Any], context: Context
) -> dict[str, Any] | None:
    """The chain once more at the horizon from which on S_sync holds every certified start; None without one."""
    horizon = next(
        (
            entry["horizon_s"]
            for entry in outputs["horizon_contained_s"]
            if (entry["inner"], entry["outer"]) == ("certified", "synchronize")
        ),
        None,
    )
    if horizon is None:
        return None
    sets = [name for name in inputs["sets"] if name in (*CHAIN, "analytical")]
    asked = {**inputs, "sets": sets, "horizon_s": horizon, "containment_up_to_s": 0}
    found: dict[str, Any] = execute("inclusion-chain", asked, context).document["outputs"]
    return {"horizon_s": horizon, **found}


def show(document: dict[str, Any]) -> None:
    """Print the chain's links, then every pair of sets, then the notes on each point."""
    table, said = table_of("Eq. (12): is each set inside the next?", _COLUMNS), []
    for point in document["points"]:
        cells = {row["name"]: row["cells"] for row in point["sets"]}
        for link in point["chain"]:
            found = _example(point, link["inner"], link["outer"])
            where = "-" if found is None else f"({found['x_m']:.3f}, {found['y_m']:.3f}) m"
            if found is not None:
                said.append(f"{point['omega_t_deg_s']:g} deg/s, {where}: {found['evidence']}")
            table.add_row(
                f"{point['omega_t_deg_s']:g}",
                link["whose"],
                f"{link['inner']} in {link['outer']}",
                str(cells[link["inner"]]),
                "-" if link["cells"] is None else str(link["cells"]),
                number(link["violation_fraction"]),
                where,
            )
        table.add_section()
    out.print(table)
    for line in said:
        out.print(f"- {line}")
    for point in document["points"]:
        _late(point)
    for point in document["points"]:
        _matrix(point)
        for line in point["notes"]:
            out.print(f"- {line}")


def _late(point: dict[str, Any]) -> None:
    """Print the chain at the horizon of containment: ours without a counter-example, the paper's beside."""
    late = point["at_containment"]
    if late is None:
        return
    where = f"{point['omega_t_deg_s']:g} deg/s, from {late['horizon_s']:g} s on"
    ours = [link for link in late["chain"] if link["whose"] == "ours"]
    chain = " in ".join([ours[0]["inner"], *(link["outer"] for link in ours)])
    out.print(f"{where}: {chain}: {sum(link['cells'] or 0 for link in ours)} counter-examples")
    for thin in late["slivers"]:
        out.print(
            f"  of {thin['certified']} starts of a fine grid in {thin['inner']} {thin['cannot_stay']} are proved "
            "unable to stay so long"
        )


def _matrix(point: dict[str, Any]) -> None:
    names = list(point["violation_fraction"])
    columns: list[tuple[str, Justify]] = [("share of / outside", "left")]
    columns += [(name.replace("analytical", "ana").replace("position", "pos"), "right") for name in names]
    table = table_of(f"Violation fractions at {point['omega_t_deg_s']:g} deg/s", columns)
    for inner in names:
        row = point["violation_fraction"][inner]
        table.add_row(inner, *("·" if inner == outer else number(row[outer]) for outer in names))
    out.print(table)


def _example(point: dict[str, Any], inner: str, outer: str) -> dict[str, Any] | None:
    pairs = ((e["inner"], e["outer"], e) for e in point["counter_examples"])
    return next((e for one, other, e in pairs if (one, other) == (inner, outer)), None)

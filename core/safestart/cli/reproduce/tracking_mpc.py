"""``safestart reproduce tracking-mpc``: the case of paper 002, and its limit on theta for further targets."""

from __future__ import annotations

from typing import Any

import typer

from safestart.cli.console import Json, Justify, number, out, print_json, reporting, table_of
from safestart.processes.execute import execute
from safestart.processes.tracking_mpc.targets import TARGETS

PAPER = "Envisat, Table I, T = 1 s, 0.075 m/s, N_c = 3, N = 30; LVLH taken as inertial"
PUBLISHED = {"theta_max_m": 3.597, "y_max_m": 2.008, "n_c_with_theta_zero": 35}
WEIGHTS = ((1.0, 1.0), (1.0, 100.0), (100.0, 100.0))
LONGEST = 60
NOTES = (
    "The paper prints theta_max, y_max and the horizon. We computed the times and impulses for its case, one row for "
    "each pair of weights.",
    "With theta = 0 the paper needs N_c = 35 for the start of Table I. This start needs fewer steps; the region needs "
    "35 to come close to the exact one.",
    "The printed theta_max leaves out the centripetal term of (35). For spins near a principal axis it therefore "
    "allows values of theta that the input cannot hold. The file counter_example.npz of process tracking-mpc shows "
    "such a flight.",
)

_FLIGHTS: tuple[tuple[str, Justify], ...] = (
    ("rho", "right"),
    ("tau", "right"),
    ("< 5 cm s", "right"),
    ("< 1 cm s", "right"),
    ("m/s", "right"),
)
_LIMITS: tuple[tuple[str, Justify], ...] = (
    ("target", "left"),
    ("printed", "right"),
    ("", "left"),
    ("ball", "right"),
    ("exact", "right"),
    ("needs", "right"),
    ("starts", "right"),
)


def register(group: typer.Typer) -> None:
    """Add the command to the group ``reproduce``."""

    @group.command("tracking-mpc")
    def tracking_mpc(as_json: Json = False) -> None:
        """Paper 002: limits on theta, convergence, horizons, and further targets."""
        document = tracking_mpc_document()
        print_json(document) if as_json else show(document)


def tracking_mpc_document() -> dict[str, Any]:
    """``flights`` by weights, ``published`` beside ``ours``, ``targets``, ``notes``."""
    flights = []
    paper = {"attitude_reference": "lvlh", "theta_limit": "printed"}
    with reporting("tracking MPC") as context:
        for rho, tau in WEIGHTS:
            asked = paper | {"rho": rho, "tau": tau}
            outputs = execute("tracking-mpc", asked, context).document["outputs"]
            names = ("time_to_5cm_s", "time_to_1cm_s", "impulse_m_s", "cost")
            flights.append({"rho": rho, "tau": tau, **{name: outputs[name] for name in names}})
        ours = {
            "theta_max_m": outputs["theta_max_m"]["printed"],
            "y_max_m": outputs["y_max_m"]["printed"],
            "n_c_with_theta_zero": _shortest(paper),
        }
        targets = [_target(name, body, context) for name, body in TARGETS.items()]
    return {
        "paper": PAPER,
        "published": PUBLISHED,
        "ours": ours,
        "flights": flights,
        "targets": targets,
        "notes": list(NOTES),
    }


def show(document: dict[str, Any]) -> None:
    """Print them."""
    out.print(f"Paper 002: {document['paper']}")
    for name, printed in document["published"].items():
        out.print(f"{name}: printed {printed:g}, ours {document['ours'][name]:.4g}")
    table = table_of("Flights by weights", _FLIGHTS)
    for row in document["flights"]:
        table.add_row(
            f"{row['rho']:g}",
            f"{row['tau']:g}",
            number(row["time_to_5cm_s"]),
            number(row["time_to_1cm_s"]),
            f"{row['impulse_m_s']:.3f}",
        )
    out.print(table)
    table = table_of(
        "theta_max [m], m/s to stay at the printed corner, starts: printed, polytope, exact", _LIMITS
    )
    for row in document["targets"]:
        table.add_row(
            row["target"],
            number(row["printed_m"]),
            "safe" if row["printed_is_safe"] else "UNSAFE",
            number(row["ball_m"]),
            f"{row['exact_low_m']:.2f}-{row['exact_high_m']:.2f}",
            "-" if row["counter_example_m_s"] is None else number(row["counter_example_m_s"]),
            f"{row['printed_taken']} {row['polytope_taken']} {row['exact']}",
        )
    out.print(table)
    for line in document["notes"]:
        out.print(f"- {line}")


def _shortest(paper: dict[str, Any]) -> int | None:
    """Least N_c with which theta = 0 has a plan from Table I's start."""
    from safestart.processes.tracking_mpc.setup import setup_of
    from safestart.processes.tracking_mpc.spec import TrackingMpcInputs

    for n_c in range(1, LONGEST + 1):
        asked = paper | {"theta_limit": "zero", "n_c": n_c, "n_lqr": max(30, n_c)}
        setup = setup_of(TrackingMpcInputs.model_validate(asked))
        if setup.program.plan(setup.attitudes, setup.start).feasible:
            return n_c
    return None


def _target(name: str, body: dict[str, Any], context: Any) -> dict[str, Any]:
    asked = body | {"attitude_reference": "lvlh", "region": {"rows": 30}, "steps": 60}
    found = {
        limit: execute("tracking-mpc", asked | {"theta_limit": limit}, context).document["outputs"]
        for limit in ("printed", "polytope")
    }
    outputs = found["polytope"]
    example, limits = outputs["printed_counter_example"], outputs["theta_max_m"]
    return {
        "target": name,
        "printed_m": limits["printed"],
        "ball_m": limits["ball"],
        "exact_low_m": limits["exact_low"],
        "exact_high_m": limits["exact_high"],
        "printed_is_safe": limits["printed_is_safe"],
        "counter_example_m_s": None if example is None else example["largest_input_m_s"],
        "printed_taken": found["printed"]["region"]["mpct"]["count"],
        "polytope_taken": outputs["region"]["mpct"]["count"],
        "exact": outputs["region"]["exact"]["count"],
    }

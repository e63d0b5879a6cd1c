"""What the figures of tracking-mpc say in words. Light: no solver."""

from __future__ import annotations

from typing import Any

from safestart.processes.tracking_mpc.spec import TrackingMpcInputs

COST_TOLERANCE = 1e-9


def statements(inputs: TrackingMpcInputs, document: dict[str, Any]) -> list[dict[str, str]]:
    """Verdicts of one request, the answer first."""
    certificate, limit = document["certificate"], document["theta_max_m"]
    proved = document["exact_infeasibility_proved"]
    said = [
        (
            "The controller has a plan from this start",
            "HELD" if document["feasible"] else "BROKEN",
            f"least violation {_shown(document['least_violation_m'])} m; u_max over an input's limit counts as 1 m",
        ),
        (
            f"Some impulse history keeps the corridor for {inputs.steps} steps",
            "HELD" if document["exact_feasible"] else ("BROKEN" if proved else "UNDECIDED"),
            f"least violation {_shown(document['exact_violation_m'])} m of the corridor alone; not comparable",
        ),
    ]
    if certificate is not None:
        recursive, settled = certificate["recursive_feasibility"], document["time_to_5cm_s"]
        flown = len(document["inputs_m_s"])
        said += [
            (
                "The flight arrives: it ends within 5 cm of the port",
                "HELD" if settled is not None else "BROKEN",
                f"{_shown(document['range_m'][-1])} m after {document['time_s'][-1]:g} s",
            ),
            (
                "Every plan is one for all later steps",
                "HELD" if recursive["holds"] else "BROKEN",
                f"{recursive['plans']} of {flown} plans, least slack {_shown(recursive['least_corridor_m'])} m",
            ),
            (
                "The cost falls by at least the stage cost",
                "HELD" if (certificate["cost_decrease_margin"] or 0.0) <= COST_TOLERANCE else "BROKEN",
                f"largest share missing {_shown(certificate['cost_decrease_margin'])}",
            ),
            (
                "The input suffices to stay at theta at every attitude",
                "HELD" if certificate["theta_held_for_ever"] else "UNDECIDED",
                f"proved up to {_shown(limit['exact_low'])} m, for this target {certificate['theta_window_s']:g} s",
            ),
        ]
    if inputs.theta_limit == "printed":
        said.append(
            (
                "The printed theta_max is safe",
                "SAFE" if limit["printed_is_safe"] else "UNSAFE",
                f"printed {_shown(limit['printed'])} m, exact at most {_shown(limit['exact_high'])} m",
            )
        )
    return [{"statement": text, "verdict": verdict, "figure": figure} for text, verdict, figure in said]


def notes(inputs: TrackingMpcInputs, flight: Any) -> list[str]:
    """What the figures leave out."""
    said = [
        "Rows hold at the nodes; between them nothing is promised: the least distance there is sampled.",
        "verdict_holds_until_s comes from a sampled ensemble of inertias and rates; it is no proof.",
    ]
    if not flight.plans:
        said.append("No plan from the start: nothing is flown.")
    elif not flight.finished:
        said.append(f"The program lost its plan after {len(flight.plans)} of {inputs.steps} steps.")
    if inputs.truth != "hcw":
        said.append("Flown in two-body motion with J2; plans and certificate speak of HCW.")
    return said


def _shown(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"

"""The outputs of tracking-mpc."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from safestart.processes.base import WireModel
from safestart.processes.wire import Confusion


class ThetaMax(WireModel):
    """Distance from the target up to which the input suffices to stay, m; null: any (printed: or thrust is held)."""

    printed: float | None = Field(description="Rebollo et al., (39)-(41): leaves out the centripetal term.")
    ball: float | None = Field(description="Rigorous, closed form, all attitudes.")
    exact_low: float | None = Field(
        description="The exact one over all phases and attitudes is at least this."
    )
    exact_high: float | None = Field(description="And at most this.")
    printed_is_safe: bool | None = Field(
        description="The printed one is at most exact_low; null: thrust is held, and the formula is about impulses."
    )


class YMax(WireModel):
    """Cuts of the corridor for theta, m; null: none is small enough, or any will do."""

    printed: float | None
    corners: float | None


class PrintedCounterExample(WireModel):
    """A theta that the printed limit allows and the input cannot hold; its flight is in counter_example.npz."""

    theta_m: list[float]
    time_s: float = Field(description="First step whose input is above the limit.")
    largest_input_m_s: float = Field(description="Largest input that staying there needs.")


class Recursive(WireModel):
    """Whether every step's plan is one for the next steps, too."""

    holds: bool
    plans: int = Field(description="Plans certified, of as many as were flown.")
    least_corridor_m: float | None = Field(description="Least slack of all candidates.")
    least_input_m_s: float | None
    beyond: float | None = Field(description="Bound on what candidates after the last one shown are off.")
    shifts: int = Field(description="Candidates evaluated per plan.")


class Certificate(WireModel):
    """What is guaranteed about this request."""

    recursive_feasibility: Recursive
    cost_decrease_margin: float | None = Field(
        description="Largest (V(k+1) - V(k) + stage cost) / V(k); at most 0: falls as promised."
    )
    theta_held_for_ever: bool = Field(
        description="Every theta is inside the radius proved for all attitudes."
    )
    theta_window_s: float = Field(
        description="Time over which theta's own rows were imposed or can be evaluated, s."
    )
    verdict_holds_until_s: float | None = Field(
        description="Until then the path is within 1 cm of the corridor of every body of the ensemble; sampled."
    )
    between_nodes_m: float | None = Field(
        description="Least distance to the corridor between nodes, sampled."
    )


class Statement(WireModel):
    """A verdict of the certificate in words."""

    statement: str
    verdict: str
    figure: str


class Mask(WireModel):
    """Which of the starts, in the order of x_m and y_m."""

    count: int
    mask: list[bool]


class NamedSet(WireModel):
    """A set of starts."""

    set: Literal["tracking_mpc", "arrives", "any_history"]
    cells: int


class NamedConfusion(Confusion):
    """A set (claimed) against any impulse history (true)."""

    claim: Literal["tracking_mpc", "arrives"]


class Region(WireModel):
    """Starts at rest in LVLH by layers of z, and which of them are feasible; masks are in region.npz, too."""

    x_m: list[float]
    y_m: list[float]
    z_m: list[float]
    mpct: Mask = Field(description="The controller's program has a plan.")
    arrives: Mask = Field(
        description="Of these: its loop, flown without errors for `steps` steps, keeps every row and ends within 5 cm."
    )
    exact: Mask = Field(description="Some history keeps every row at the nodes.")
    share: float | None = Field(description="Of the starts that any history can bring in, those MPCT can.")
    iou: float | None
    confusion: dict[str, int] = Field(description="MPCT (claimed) against exact (true): tp, fp, fn, tn.")
    sets: list[NamedSet]
    matrices: list[NamedConfusion]


class StudyOutputs(WireModel):
    """Requirements with their Wilson intervals of 95 %, and spreads."""

    runs: int
    variant: str
    requirements: dict[str, dict[str, Any]]
    spreads: dict[str, dict[str, Any]]
    worst: list[dict[str, Any]]


class TrackingMpcOutputs(WireModel):
    """Answer, certificate, flight; then region and study where they were asked for."""

    feasible: bool = Field(description="The controller has a plan from the start.")
    exact_feasible: bool = Field(description="Some impulse history keeps the corridor at all nodes.")
    least_violation_m: float | None = Field(
        description="Least t > 0 with which there is a plan: corridor overstepped by t, later inputs by t u_max per m. "
        "Not comparable with exact_violation_m."
    )
    exact_violation_m: float | None = Field(
        description="Least violation of the corridor by any history, inputs within their limit; negative: room to "
        "spare. Not comparable with least_violation_m, which lets inputs exceed theirs, too."
    )
    exact_infeasibility_proved: bool = Field(description="A dual solution shows that no history exists.")
    theta_max_m: ThetaMax
    y_max_m: YMax
    printed_counter_example: PrintedCounterExample | None = Field(
        description="null: within the window every theta of the printed limit can be held."
    )
    cost: float | None
    theta_m: list[float] | None = Field(description="Artificial reference of the first plan, body axes.")
    inputs_m_s: list[list[float]] = Field(description="Flown, k x 3, body axes.")
    time_to_5cm_s: float | None
    time_to_1cm_s: float | None
    impulse_m_s: float | None = Field(description="Sum of the inputs' lengths.")
    certificate: Certificate | None
    statements: list[Statement]
    time_s: list[float] = Field(description="Nodes of the flight.")
    range_m: list[float]
    cost_to_go: list[float | None]
    slack_m: list[float]
    position_lvlh_m: list[list[float]]
    position_body_m: list[list[float]]
    thetas_m: list[list[float]]
    predicted_body_m: list[list[float]] = Field(description="Path of the first plan.")
    region: Region | None
    study: StudyOutputs | None
    notes: list[str]
    shards_done: int

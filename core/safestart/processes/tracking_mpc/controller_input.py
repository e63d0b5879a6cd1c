"""The tracking MPC as method of another question: its answer on the wire."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from safestart.processes.base import WireModel


class TrackingAnswer(WireModel):
    """What the tracking MPC does with a start, beside the exact answer."""

    feasible: bool = Field(description="Its first program has a plan that keeps every row.")
    arrives_s: float | None = Field(
        description="When its nominal flight is at rest at the port, s; null: not within within_s."
    )
    certified: bool = Field(description="Every plan of the flight is one for all later steps: none is lost.")
    margin_m: float | None = Field(
        description="Proved distance of the flight to every face, m, at all times until it arrives and until horizon_s."
    )
    theta_m: list[float] | None = Field(description="Artificial reference of the first plan, body axes, m.")
    least_violation_m: float | None = Field(
        description="Least t > 0 with which the first program has a plan: corridor overstepped by t m, later inputs "
        "by t u_max per m. Not comparable with exact_margin_m."
    )
    delta_v_m_s: float | None = Field(description="Impulse of the flight, m/s.")
    exact_verdict: Literal["GO", "NO_GO", "UNDECIDED"]
    exact_margin_m: float | None = Field(description="Proved bound on the margin of any thrust history, m.")

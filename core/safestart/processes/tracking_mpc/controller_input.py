"""The tracking MPC as method of another question: its settings and its answer on the wire."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from safestart.processes.base import WireModel


class TrackingSettings(WireModel):
    """Settings of the tracking MPC, which holds its thrust over steps of 2 s."""

    n_c: int = Field(10, ge=1, le=60, description="Free inputs of a plan.")
    n_lqr: int = Field(30, ge=1, le=200, description="Steps of the regulator after them.")
    rho: float = Field(100.0, gt=0, le=1e6, description="Weight of |u - u_e|^2, u in m/s per step.")
    tau: float = Field(10.0, ge=0, le=1e6, description="Weight of |theta|^2.")
    theta_limit: Literal["corners", "polytope", "zero"] = Field(
        "polytope", description="Limit on the artificial reference, as for tracking-mpc."
    )

    @model_validator(mode="after")
    def _horizons(self) -> TrackingSettings:
        if self.n_c > self.n_lqr:
            raise ValueError(f"n_c: at most n_lqr, {self.n_lqr}, received {self.n_c}")
        return self


class TrackingAnswer(WireModel):
    """What the tracking MPC does with a start, beside the exact answer."""

    feasible: bool = Field(description="Its first program has a plan that keeps every row.")
    arrives_s: float | None = Field(
        description="When its nominal flight is at rest at the port, s; null: not within within_s."
    )
    certified: bool = Field(description="Every plan of the flight is one for all later steps: none is lost.")
    margin_m: float | None = Field(description="Proved distance of the flight to every face at all times, m.")
    theta_m: list[float] | None = Field(description="Artificial reference of the first plan, body axes, m.")
    least_violation_m: float | None = Field(
        description="Least violation of the first program where it has no plan."
    )
    delta_v_m_s: float | None = Field(description="Impulse of the flight, m/s.")
    exact_verdict: Literal["GO", "NO_GO", "UNDECIDED"]
    exact_margin_m: float | None = Field(description="Proved bound on the margin of any thrust history, m.")

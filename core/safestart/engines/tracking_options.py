"""Settings of the tracking MPC as they cross the wire, for its engine and its go-no-go method; light to import."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from safestart.model.wire_model import WireModel


class TrackingSettings(WireModel):
    """Settings of the tracking MPC, which holds its thrust over steps of 2 s."""

    n_c: int = Field(10, ge=1, le=60, description="Free inputs of a plan.")
    n_lqr: int = Field(30, ge=1, le=200, description="Steps of the regulator after them.")
    rho: float = Field(100.0, gt=0, le=1e6, description="Weight of |u - u_e|^2, u in m/s per step.")
    tau: float = Field(10.0, ge=0, le=1e6, description="Weight of |theta|^2.")
    theta_limit: Literal["corners", "polytope"] = Field(
        "polytope",
        description="Limit on the artificial reference, as for tracking-mpc; not zero, the target's centre, which is "
        "behind the hold plane.",
    )

    @model_validator(mode="after")
    def _horizons(self) -> TrackingSettings:
        if self.n_c > self.n_lqr:
            raise ValueError(f"n_c: at most n_lqr, {self.n_lqr}, received {self.n_c}")
        return self

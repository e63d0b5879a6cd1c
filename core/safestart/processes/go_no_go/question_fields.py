"""The exact questions about one start, beyond the closed form, as they appear on the wire."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from safestart.engines.tracking_options import TrackingSettings
from safestart.model.scenario import MAX_RANGE
from safestart.processes.go_no_go.method_registry import DEFAULT, METHODS, RENAMED, MethodName
from safestart.processes.go_no_go.uncertainty import HalfWidths
from safestart.processes.wire import Horizon

QuestionKind = Literal["stay", "synchronize"]
AfterArrival = Literal["stay", "hold", "any"]


class QuestionFields(HalfWidths):
    """Method and exact question; only the proving methods accept fields other than the method."""

    method: MethodName = Field(
        DEFAULT,
        description=" ".join(
            [
                *(f"{method.name}: {method.text}." for method in METHODS.values()),
                *(f"{old}: deprecated name of {new}." for old, new in RENAMED.items()),
            ]
        ),
    )
    question: QuestionKind = Field(
        "stay",
        description="stay: in the corridor at all times of horizon_s. synchronize: in addition at rest in the body "
        "frame inside a ball around the hold point at the end, at some time up to within_s.",
    )
    horizon_s: Horizon = Field(60.0, description="How long to stay, s.")
    within_s: Horizon = Field(200.0, description="Latest end of synchronize, s.")
    hold_x_m: float = Field(0.0, ge=-MAX_RANGE, le=MAX_RANGE, description="Hold point, body-frame x, m.")
    hold_y_m: float | None = Field(
        None, ge=0, le=MAX_RANGE, description="Hold point, body-frame y, m; absent: the hold radius."
    )
    hold_z_m: float = Field(
        0.0, ge=-MAX_RANGE, le=MAX_RANGE, description="Hold point, body-frame z, m; for spatial starts."
    )
    ball_radius_m: float = Field(0.5, ge=0.001, le=1000, description="Ball around the hold point, m.")
    rest_speed_m_s: float = Field(
        0.05, ge=1e-4, le=100, description="Largest speed in the body frame that counts as at rest, m/s."
    )
    after_arrival: AfterArrival = Field(
        "stay",
        description="stay: GO of synchronize needs a proof that the chaser stays for ever after its end, else it is "
        "UNDECIDED. hold: it needs a proof that an LQR with thrust held over steps keeps it there for ever, and every "
        "state of an ellipsoid around it (planar; see hold_after). any: what comes after the end is not asked.",
    )
    speed_limit_m_s: float | None = Field(
        None, ge=0.001, le=1000, description="Largest LVLH speed at all times, m/s; absent: none."
    )
    keep_out_m: float = Field(
        0.0,
        ge=0,
        le=MAX_RANGE,
        description="Keep-out radius around the target's centre, m; at most r_h_m, where the hold plane implies it.",
    )
    disturbance_m_s2: float = Field(
        0.0,
        ge=0,
        le=1,
        description="Bound on an unknown acceleration at all times, m/s^2 (stay): GO then holds against every such "
        "disturbance, by a feedback whose margin and thrust are set aside; its proof holds the tube.",
    )
    start_error_m: float = Field(
        0.0, ge=0, le=1000, description="Bound on the error of the start's position, m (stay)."
    )
    start_error_m_s: float = Field(
        0.0, ge=0, le=10, description="Bound on the error of its velocity, m/s (stay)."
    )
    tracking: TrackingSettings | None = Field(
        None, description="Settings of the tracking MPC (method tracking); absent: their defaults."
    )
    proofs: bool = Field(
        False, description="Return proof documents (methods that prove); at most 100 starts."
    )

    @model_validator(mode="after")
    def _settings_of_its_method(self) -> QuestionFields:
        if self.tracking is not None and self.method != "tracking":
            raise ValueError(f"tracking: only with method tracking, received {self.method}")
        return self

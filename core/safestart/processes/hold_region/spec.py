"""hold-region: from which errors the LQR keeps the hold point within corridor and thrust (paper 000, section 8.3)."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.views import Column, Facts, Rows
from safestart.processes.wire import ScenarioInput, Seed

SetName = Literal["ellipsoid", "polyhedron", "beyond_polyhedron", "regime"]


class HoldRegionInputs(ScenarioInput):
    """The scenario, the hold point, and the LQR."""

    hold_clearance_m: float = Field(
        1.5, gt=0, le=1000, description="The hold point lies at (0, r_h + this) in the body frame, m."
    )
    dt_s: float = Field(2.0, ge=0.1, le=10, description="Length of a control interval, s.")
    position_scale_m: float = Field(
        1.0, ge=1e-3, le=1e4, description="LQR: weight 1 / scale^2 of the position error."
    )
    velocity_scale_m_s: float = Field(
        0.1, ge=1e-5, le=100, description="LQR: the same of the velocity error."
    )
    thrust_scale_m_s2: float | None = Field(
        None, ge=1e-7, le=100, description="LQR: the same of the thrust; null: a_max_m_s2."
    )
    phase_deg: float = Field(
        0.0,
        ge=-360,
        le=360,
        description="Angle of the body against LVLH at the start (the polyhedron's), deg.",
    )
    preset: Literal["tuned", "paper"] = Field(
        "tuned",
        description="Gains of the three-regime controller, whose own hold is examined beside the LQR.",
    )
    flights: int = Field(40, ge=0, le=1000, description="Flights from the boundary of each set; 0: none.")
    seed: Seed = 0


class EllipsoidOutput(WireModel):
    """{e' P e <= level} in the error (x, y, vx, vy), LVLH; valid at every angle of the body."""

    level: float
    limited_by: str = Field(description="The face, or thrust.")
    half_extents: list[float] = Field(description="m, m, m/s, m/s.")
    volume_m4_s2: float


class PolyhedronOutput(WireModel):
    """The largest set from which the loop never meets a limit, for one angle of the body at the start."""

    faces: int
    vertices: int
    steps: int = Field(description="Steps after which every start is in the ellipsoid.")
    low: list[float] = Field(description="Least errors, m, m, m/s, m/s.")
    high: list[float]
    volume_m4_s2: float
    volume_ratio: float = Field(description="Over the ellipsoid's volume.")


class RegimeOutput(WireModel):
    """What the three-regime controller keeps by its own hold: {e' P e <= level} in the errors of (x, y, vx, vy) and of
    the previous command (ux, uy), LVLH, about where it settles; valid at every angle of the body."""

    code: Literal["ok", "unstable", "no_hold"] = Field(
        description="unstable: the law with the filter's weight on moves does not shrink errors; no_hold: where it "
        "settles meets a limit."
    )
    spectral_radius: float = Field(description="Of the errors' step; 1 or more: unstable.")
    level: float
    limited_by: str | None = Field(
        description="A face, thrust, filter (a row of its forecast), hold_band, switch_speed or sync_radius."
    )
    half_extents: list[float] | None = Field(description="m, m, m/s, m/s, m/s², m/s².")
    settles_m: list[float] | None = Field(
        description="Where it settles, body frame, m; it circles about it by um."
    )
    cost: list[list[float]] | None = Field(description="P (6 x 6).")


class FlownHoldOutput(WireModel):
    """Flights from a set's boundary; from beyond_polyhedron, at 1.02 of its vertices, all must fail."""

    set: SetName
    starts: int
    held: int
    least_margin_m: float | None
    most_thrust_m_s2: float | None


class HoldRegionOutputs(WireModel):
    """Gain, cost, both sets and their flights; the polyhedron's rows are in the NPZ artifact."""

    code: Literal["ok", "no_hold", "not_closed"] = Field(
        description="no_hold: the hold point itself asks for more thrust or room than there is; not_closed: the "
        "polyhedron was not found."
    )
    gain: list[list[float]] = Field(description="K (2 x 4), 1/s^2 and 1/s: thrust = reference - K error.")
    cost: list[list[float]] = Field(description="P (4 x 4).")
    spectral_radius: float
    reference_thrust_m_s2: float = Field(description="Largest thrust that the hold point itself asks for.")
    ellipsoid: EllipsoidOutput | None
    polyhedron: PolyhedronOutput | None
    regime: RegimeOutput
    flown: list[FlownHoldOutput]


SPEC = ProcessSpec(
    id="hold-region",
    title="Region that the hold keeps",
    description=(
        "Station keeping at the hold point of a turning target by LQR (Iskender et al., section 8.3): the largest "
        "ellipsoid of errors that stays within corridor and thrust limit at all times and every angle of the body, and "
        "the largest set at all from which the loop meets no limit, a polyhedron. Beside them the ellipsoid that the "
        "three-regime controller keeps for ever by its own hold. All are flown from their boundary."
    ),
    inputs=HoldRegionInputs,
    outputs=HoldRegionOutputs,
    run="safestart.processes.hold_region.run:run",
    replay_tolerance=1e-6,
    views=(
        Facts(
            (
                Column("Code", "code"),
                Column("Spectral radius", "spectral_radius"),
                Column("Thrust of the hold point itself [m/s²]", "reference_thrust_m_s2"),
                Column("Ellipsoid limited by", "ellipsoid.limited_by"),
                Column("its half extents [m, m/s]", "ellipsoid.half_extents"),
                Column("Polyhedron: faces", "polyhedron.faces"),
                Column("steps", "polyhedron.steps"),
                Column("volume over the ellipsoid's", "polyhedron.volume_ratio"),
            )
        ),
        Facts(
            (
                Column("The controller's own hold", "regime.code"),
                Column("spectral radius", "regime.spectral_radius"),
                Column("settles at [m, body frame]", "regime.settles_m"),
                Column("its ellipsoid limited by", "regime.limited_by"),
                Column("half extents [m, m/s, m/s²]", "regime.half_extents"),
            )
        ),
        Rows(
            "Flights",
            "flown",
            (
                Column("from the boundary of", "set"),
                Column("starts", "starts"),
                Column("held", "held"),
                Column("least margin [m]", "least_margin_m"),
                Column("most thrust [m/s²]", "most_thrust_m_s2"),
            ),
        ),
    ),
    keywords=("hold", "LQR", "region of attraction", "invariant set"),
    example={"omega_t_deg_s": 3, "a_max_m_s2": 0.1},
)

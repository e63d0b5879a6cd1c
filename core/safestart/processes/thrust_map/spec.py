"""thrust-map: certified share of the corridor over (tumble rate, thrust), and the thrust a stand-off asks for."""

from __future__ import annotations

from pydantic import Field, model_validator

from safestart.closed_form.by_name import ClosedForm
from safestart.model.scenario import MAX_MEAN_MOTION, Rest
from safestart.processes.base import ProcessSpec, Table, WireModel
from safestart.processes.costs import FIRST_S
from safestart.processes.coverage.spec import Rates, Thrusts
from safestart.processes.views import Column, Layer, Picture, Rows
from safestart.processes.wire import Certificate, CorridorInput

PROVED_FOR_S = 60.0
"""How long a start is proved to stay with the thrust that certificate=paper calls required, s."""


_RATE_S, _SHARE_S = 4e-3, 2e-4


class ThrustMapInputs(WireModel):
    """Tumble rates, thrust levels, and the distance at which the approach is to start."""

    omega_t_deg_s: Rates = Field([0.5 * k for k in range(1, 21)], description="Tumble rates, deg/s.")
    a_max_m_s2: Thrusts = Field(
        [0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5],
        description="Thrust accelerations, m/s^2.",
    )
    stand_off_m: float = Field(40.0, gt=0, le=5000, description="Start on the corridor's axis, m.")
    y_max_m: float = Field(150.0, gt=0, le=5000, description="Where the corridor is cut, m.")
    rest: Rest = Field(Rest.LVLH, description="Frame in which the starts are at rest.")
    mean_motion_rad_s: float = Field(1.1e-3, ge=0, le=MAX_MEAN_MOTION, description="Mean motion, rad/s.")
    corridor: CorridorInput = Field(default_factory=CorridorInput)
    certificate: Certificate = "certified"

    @model_validator(mode="after")
    def _inside(self) -> ThrustMapInputs:
        if self.y_max_m <= self.corridor.r_h_m:
            raise ValueError("y_max_m: more than corridor.r_h_m")
        return self


class ThrustMapOutputs(WireModel):
    """``safe_percent[rate][thrust]``; ``required_a_max_m_s2[rate]``; those of ``paper`` beside."""

    certificate: ClosedForm = Field(description="The requested closed form.")

    omega_t_deg_s: list[float]
    a_max_m_s2: list[float]
    safe_percent: list[list[float]] = Field(description="Certified share of the corridor, percent.")
    required_a_max_m_s2: list[float | None] = Field(
        description="Thrust with which the start (0, stand_off_m) is certified, a little less does not do. certified: "
        "a known manoeuvre stays for ever. paper: some thrust is proved to stay for 60 s. null: none up to 10 m/s^2."
    )
    paper_safe_percent: list[list[float]] = Field(
        description="Share by the paper's conditions, which are not sound, percent."
    )
    paper_required_a_max_m_s2: list[float | None] = Field(
        description="Smallest thrust that meets the paper's conditions there; not sound, the start may be lost with it."
    )


SPEC = ProcessSpec(
    id="thrust-map",
    title="What more thrust buys",
    description=(
        "Certified share of the corridor for each pair of tumble rate and thrust, and for each tumble rate the thrust "
        "that certifies a start on the corridor's axis at the wanted stand-off: a known manoeuvre keeps it in the "
        "corridor for ever. The paper's conditions, not sound, stand beside, or are asked by certificate=paper."
    ),
    inputs=ThrustMapInputs,
    outputs=ThrustMapOutputs,
    run="safestart.processes.thrust_map.run:run",
    light=True,
    cost=lambda inputs: (
        FIRST_S
        + _RATE_S * len(inputs.omega_t_deg_s)
        + _SHARE_S * len(inputs.a_max_m_s2) * len(inputs.omega_t_deg_s)
    ),
    tables=(
        Table("safe_percent", ("safe_percent", "paper_safe_percent"), axes=("omega_t_deg_s", "a_max_m_s2")),
        Table(
            "required_a_max_m_s2",
            ("omega_t_deg_s", "required_a_max_m_s2", "paper_required_a_max_m_s2"),
        ),
    ),
    views=(
        Rows(
            "Required thrust",
            "required_a_max_m_s2",
            (
                Column("tumble rate [deg/s]", "omega_t_deg_s"),
                Column("required thrust [m/s²]", "required_a_max_m_s2"),
                Column("by the paper's conditions, not sound [m/s²]", "paper_required_a_max_m_s2"),
            ),
        ),
        Rows(
            "Certified share",
            "safe_percent",
            (
                Column("tumble rate [deg/s]", "omega_t_deg_s"),
                Column("thrust [m/s²]", "a_max_m_s2"),
                Column("certified [%]", "safe_percent"),
                Column("by the paper's conditions, not sound [%]", "paper_safe_percent"),
            ),
        ),
        Picture(
            "Certified share of the corridor [%]",
            "tumble rate [deg/s]",
            "thrust acceleration [m/s²]",
            (
                Layer(
                    "certified [%]",
                    "heat",
                    "safe_percent",
                    "omega_t_deg_s",
                    "a_max_m_s2",
                    value="safe_percent",
                ),
                Layer(
                    "needed at the stand-off",
                    "line",
                    "required_a_max_m_s2",
                    "omega_t_deg_s",
                    "required_a_max_m_s2",
                    colour="lost",
                ),
            ),
            logarithmic=True,
        ),
    ),
    keywords=("certificate", "trade study"),
    example={"omega_t_deg_s": [1, 3, 5], "a_max_m_s2": [0.05, 0.1, 0.2], "stand_off_m": 40},
)

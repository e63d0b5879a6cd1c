"""flight-in-space: fly one start, by the exact answer's thrust history or in closed loop, and watch it at all times."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from safestart.processes.base import ProcessSpec, Table, WireModel
from safestart.processes.costs import FIRST_S, program_s
from safestart.processes.start_in_space.flight_output import SpaceFlight
from safestart.processes.start_in_space.parts import SpaceStart
from safestart.processes.start_in_space.space_scenario import SpaceScenario
from safestart.processes.views import Column, Findings, Layer, Picture
from safestart.processes.wire import Horizon, Seed

FlownBy = Literal["exact", "sequence"]
_SHOWN_FACES = 8


def _start() -> SpaceStart:
    return SpaceStart(position_m=[2.0, 25.0, 1.0], frame="body")


class _Start(WireModel):
    """Stands last among the bases, so that the start is the first field."""

    start: SpaceStart = Field(default_factory=_start, description="State at t = 0.")


class FlightInSpaceInputs(SpaceScenario, _Start):
    """One scenario, one start, and who flies it."""

    flown_by: FlownBy = Field(
        "exact",
        description="exact: the thrust history of the largest margin, for a GO that of its proof, for a NO_GO the "
        "attempt that leaves the faces least. sequence: the sequence controller in closed loop, which plans by the "
        "exact question for the rest of the flight; its flight ends where it leaves the faces.",
    )
    horizon_s: Horizon = Field(60.0, description="Flight time, s; a multiple of 2 s.")
    position_sigma_m: float = Field(
        0.0, ge=0, le=100, description="White noise of navigation, m (flown_by sequence)."
    )
    velocity_sigma_m_s: float = Field(
        0.0, ge=0, le=10, description="White noise of navigation, m/s (flown_by sequence)."
    )
    seed: Seed = 0

    @model_validator(mode="after")
    def _noise_is_flown(self) -> FlightInSpaceInputs:
        for name in ("position_sigma_m", "velocity_sigma_m_s"):
            if getattr(self, name) and self.flown_by == "exact":
                raise ValueError(
                    f"{name}: required 0 with flown_by exact, which sees no state, received {getattr(self, name)}"
                )
        return self


class FlightInSpaceOutputs(SpaceFlight):
    """The verdict on the start, and the flight as curves over ``time_s``."""

    verdict: Literal["GO", "NO_GO", "UNDECIDED"] = Field(description="Of the exact question stay.")
    margin_m: float | None = Field(description="Proved bound: from below for GO, from above for NO_GO, m.")
    model_error_m: float = Field(
        description="Estimate of what two bodies with J2 would change over the horizon, m."
    )
    flown_by: FlownBy
    faces: list[str]
    stayed: Literal["stayed", "left"] = Field(
        description="Whether the flight stayed inside all faces, at all times and not only at those of the curves."
    )
    closest_face: str
    closest_m: float = Field(
        description="Least distance to a face at any time of the flight, m; negative: outside."
    )
    closest_s: float = Field(description="When that is, s.")
    left_at_s: float | None = Field(
        description="When the flight first was seen outside a face; null if it stayed."
    )


def _cost(inputs: FlightInSpaceInputs) -> float:
    noisy = inputs.position_sigma_m > 0.0 or inputs.velocity_sigma_m_s > 0.0
    plans = 6.0 if noisy else 2.0
    return FIRST_S + 3.0 * (1.0 + plans) * program_s(inputs.horizon_s)


def _seen(title: str, frame: str, across: int, up: int) -> Picture:
    axes = "xyz"
    seen = "body frame" if frame == "body" else "LVLH"
    return Picture(
        title,
        f"{axes[across]} [m], {seen}",
        f"{axes[up]} [m], {seen}",
        (Layer("flight", "line", "flight", f"{frame}_m.{across}", f"{frame}_m.{up}"),),
        # A picture of one scale draws the corridor, which is that of the body's x and y.
        equal=(frame, across, up) == ("body", 0, 1),
    )


SPEC = ProcessSpec(
    id="flight-in-space",
    title="Flight from a start in space",
    description=(
        "Flies one start of any attitude, orbit, faces and thrusts: by the exact answer's thrust history, or by the "
        "sequence controller in closed loop with navigation noise. The flight is watched at all times. Positions, "
        "velocities and thrust in both frames, attitude, distance to every face. Flights to rest at a hold point: "
        "flights of start-in-space."
    ),
    inputs=FlightInSpaceInputs,
    outputs=FlightInSpaceOutputs,
    kernels=("exact answers",),
    run="safestart.processes.flight_in_space.run:run",
    light=True,
    cost=_cost,
    tables=(
        Table(
            "flight",
            (
                *("time_s", "body_m", "body_m_s", "lvlh_m", "lvlh_m_s", "attitude_wxyz"),
                *("thrust_m_s2", "distance_m"),
            ),
        ),
    ),
    views=(
        Findings(
            "Verdict",
            "",
            word="verdict",
            columns=(
                Column("the flight", "stayed"),
                Column("proved margin [m]", "margin_m"),
                Column("error of the model [m]", "model_error_m"),
                Column("flown by", "flown_by"),
                Column("closest [m]", "closest_m"),
                Column("to face", "closest_face"),
                Column("after [s]", "closest_s"),
                Column("left after [s]", "left_at_s"),
                Column("delta-v [m/s]", "delta_v_m_s"),
            ),
        ),
        _seen("Flight, across the body's z", "body", 0, 1),
        _seen("Flight, across the body's x", "body", 2, 1),
        _seen("Flight, across the orbit's normal", "lvlh", 0, 1),
        Picture(
            "Distance to each face",
            "time [s]",
            "distance [m]",
            tuple(
                Layer(f"{{faces.{k}}}", "line", "flight", "time_s", f"distance_m.{k}")
                for k in range(_SHOWN_FACES)
            ),
        ),
    ),
    keywords=("exact", "trajectory", "closed loop", "torque-free"),
    example={
        "start": {"position_m": [2, 25, 1], "velocity_m_s": [0, -0.1, 0], "frame": "body"},
        "attitude": {
            "kind": "torque_free",
            "inertia_kg_m2": [[17023, 0, 0], [0, 124826, 0], [0, 0, 129112]],
            "body_rate_deg_s": [0.3, 0.5, -2.0],
        },
        "orbit": {"mean_motion_rad_s": 0.00105},
        "thrust": {"kind": "ball", "a_max_m_s2": 0.1},
    },
)

"""A flight in space and the target's turning, as curves on the wire."""

from __future__ import annotations

from pydantic import Field

from safestart.processes.base import WireModel


class SpaceFlight(WireModel):
    """Curves over ``time_s``, four instants for each 2 s; vectors as rows."""

    time_s: list[float]
    lvlh_m: list[list[float]] = Field(description="Position in LVLH, m.")
    lvlh_m_s: list[list[float]] = Field(description="Velocity in LVLH, m/s.")
    body_m: list[list[float]] = Field(description="Position in the body frame, m.")
    body_m_s: list[list[float]] = Field(description="Velocity against the turning body, in its axes, m/s.")
    attitude_wxyz: list[list[float]] = Field(description="From LVLH to the body, scalar first.")
    thrust_m_s2: list[list[float]] = Field(description="Acceleration in LVLH, held over 2 s, m/s^2.")
    distance_m: list[list[float]] = Field(description="Distance to each face, m; negative: outside.")
    delta_v_m_s: float


class Turning(WireModel):
    """How the target turns over ``time_s``, every 2 s from 0 to the latest end."""

    time_s: list[float]
    attitude_wxyz: list[list[float]] = Field(description="From LVLH to the body, scalar first.")
    rate_deg_s: list[list[float]] = Field(
        description="Angular velocity against LVLH, in the body's axes, deg/s."
    )

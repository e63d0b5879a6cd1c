"""The uncertainty of a question, as it appears on the wire: half-widths of intervals and of the start box."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from safestart.processes.base import WireModel

HALF_WIDTHS = (
    "omega_t_half_width_deg_s",
    "a_max_half_width_m_s2",
    "mean_motion_half_width_rad_s",
    "position_half_width_m",
    "velocity_half_width_m_s",
)
Witness = Literal["common", "per_corner"]


class HalfWidths(WireModel):
    """Half-widths around the values asked for; any above 0 asks for a verdict proved for all of them (exact, auto)."""

    omega_t_half_width_deg_s: float = Field(
        0.0, ge=0, le=60, description="Tumble rate within +- this, deg/s; at most the rate itself."
    )
    a_max_half_width_m_s2: float = Field(
        0.0, ge=0, le=10, description="Maximum thrust within +- this, m/s^2."
    )
    mean_motion_half_width_rad_s: float = Field(
        0.0, ge=0, le=1.3e-3, description="Mean motion within +- this, rad/s."
    )
    position_half_width_m: float = Field(
        0.0, ge=0, le=1000, description="Start position within +- this along each LVLH axis, m."
    )
    velocity_half_width_m_s: float = Field(
        0.0,
        ge=0,
        le=1000,
        description="Start velocity within +- this along each LVLH axis, m/s. With rest=body the middle of the box is "
        "at rest for omega_t_deg_s itself.",
    )
    witness: Witness = Field(
        "common",
        description="What a GO for all of them shows. common: one thrust history for all. per_corner: one for each "
        "corner of the start box; the start must be known when it is flown.",
    )

    @property
    def uncertain(self) -> bool:
        """Whether any half-width is given."""
        return any(getattr(self, name) > 0.0 for name in HALF_WIDTHS)


class Member(WireModel):
    """One member of the sets with its own proved verdict: two that differ say why a verdict for all is UNDECIDED."""

    verdict: Literal["GO", "NO_GO", "UNDECIDED"]
    margin_m: float | None = Field(description="Proved bound on its margin, m.")
    omega_t_deg_s: float
    a_max_m_s2: float
    mean_motion_rad_s: float
    position_m: list[float] = Field(description="Start, LVLH, m.")
    velocity_m_s: list[float] = Field(description="Start, LVLH, m/s.")

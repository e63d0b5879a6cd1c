"""The hops of an approach along a line, as every process about them asks for them."""

from __future__ import annotations

from pydantic import Field, model_validator

from safestart.processes.base import WireModel

MOST_HOPS = 20


class HopsInput(WireModel):
    """From where to where, and how the distance is shared."""

    start_m: float = Field(2000.0, gt=0, le=1e5, description="Distance at the start, m.")
    hold_m: float = Field(100.0, gt=0, le=1e5, description="Distance of the hold point, m.")
    hops: int = Field(5, ge=1, le=MOST_HOPS, description="Number of hops.")
    gamma: float | None = Field(
        None,
        gt=0,
        le=1,
        description="Length of a hop over that of the one before; absent: distances shrink geometrically.",
    )

    @model_validator(mode="after")
    def _lead_in(self) -> HopsInput:
        if not self.hold_m < self.start_m:
            # Under the name that was given.
            if "start_m" not in self.model_fields_set:
                raise ValueError(
                    f"hold_m: less than start_m, {self.start_m:g} m, as hops lead towards the target"
                )
            raise ValueError("start_m: more than hold_m, hops lead towards the target")
        return self


def require_outside(hold_m: float, keep_out_m: float) -> None:
    """A hold point lies outside the keep-out sphere; raises ``ValueError`` under the wire's name."""
    if hold_m < keep_out_m:
        raise ValueError("hold_m: at least keep_out_m, a hold point lies outside the keep-out sphere")

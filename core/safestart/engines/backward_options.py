"""Options of the backward engine as they cross the wire; light to import."""

from __future__ import annotations

from pydantic import Field

from safestart.model.wire_model import WireModel


class BackwardInput(WireModel):
    """What the set withstands."""

    disturbance_m_s2: float = Field(
        0.0,
        ge=0,
        le=1,
        description="Disturbance on each LVLH axis, held over each interval and at most this, m/s^2: the set is "
        "robust, one input history for all disturbances. 0: the nominal set.",
    )

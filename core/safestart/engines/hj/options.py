"""Options of the Hamilton-Jacobi engine as they cross the wire; light to import."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from safestart.model.wire_model import WireModel

Accuracy = Literal["low", "medium", "high", "very_high"]


class HamiltonJacobiInput(WireModel):
    """Discretisation of the level-set engine."""

    accuracy: Accuracy = Field(
        "very_high",
        description="Scheme of hj-reachability; low is the fastest and loses a third of the set at 5 deg/s.",
    )
    solver: Literal["fused", "hj_reachability"] = Field(
        "fused",
        description="The solver: compiled kernels, or hj-reachability (same scheme, 20 to 40 times slower).",
    )
    nodes_xy: int = Field(41, ge=11, le=61, description="Nodes per position axis.")
    nodes_v: int = Field(15, ge=7, le=31, description="Nodes per velocity axis.")
    frame: Literal["auto", "lvlh", "body"] = Field(
        "auto",
        description="Frame of the grid: lvlh (the corridor turns), body (Iskender et al.; the corridor stands still), "
        "auto: lvlh, but body for tubes of starts at rest in the body frame.",
    )

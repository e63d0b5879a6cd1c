"""The switched rendezvous as it appears on the wire: dynamics, gains and guard. Light to import."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from safestart.processes.base import WireModel

TargetBox = Annotated[float, Field(gt=0, le=100, description="Half-width of the target's box, m.")]


class BrysonInput(WireModel):
    """Largest desired values in one mode, from which Bryson's rule makes Q and R."""

    x_m: float = Field(gt=0, le=1e6, description="Radial position, m.")
    y_m: float = Field(gt=0, le=1e6, description="Along-track position, m.")
    vx_m_s: float = Field(gt=1e-4, le=1e4, description="Radial velocity, m/s.")
    vy_m_s: float = Field(gt=1e-4, le=1e4, description="Along-track velocity, m/s.")
    thrust_n: float = Field(gt=1e-3, le=1e4, description="Thrust per axis, N.")


def _far() -> BrysonInput:
    return BrysonInput(x_m=1000.0, y_m=866.0, vx_m_s=1.0 / 3.0, vy_m_s=1.0 / 3.0, thrust_n=8.0)


def _near() -> BrysonInput:
    return BrysonInput(x_m=100.0, y_m=100.0, vx_m_s=0.05, vy_m_s=0.05, thrust_n=8.0)


class RendezvousInputs(WireModel):
    """The switched rendezvous of Chan and Mitra and its variants."""

    model: Literal["linear", "nonlinear"] = Field(
        "linear",
        description="Relative dynamics: Clohessy-Wiltshire-Hill with the published coefficients, or Kepler's.",
    )
    gains: Literal["published", "bryson"] = Field(
        "published", description="Published gains, or LQR gains by Bryson's rule from mode_1 and mode_2."
    )
    mode_1: BrysonInput = Field(
        default_factory=_far, description="Bryson limits of mode 1; the defaults give the published gains."
    )
    mode_2: BrysonInput = Field(default_factory=_near, description="Bryson limits of mode 2, likewise.")
    guard: Literal["octagon", "circle"] = Field(
        "octagon", description="Where mode 2 begins: the published octagon, or the true circle of 100 m."
    )

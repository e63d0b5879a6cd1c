"""certificate: the safe-start region of one operating point on a grid, in closed form."""

from __future__ import annotations

from pydantic import Field

from safestart.closed_form.by_name import ClosedForm
from safestart.model.scenario import Rest
from safestart.processes.base import ProcessSpec, Table, WireModel
from safestart.processes.views import Column, Facts, Layer, Picture
from safestart.processes.wire import Certificate, GridInput, ScenarioInput

_CELL_S = 1.5e-7


class CertificateInputs(ScenarioInput):
    """One operating point, a grid, the frame in which starts are at rest, and which closed form is asked."""

    certificate: Certificate = "certified"
    grid: GridInput = Field(default_factory=GridInput)
    rest: Rest = Field(Rest.LVLH, description="Frame in which the starts are at rest.")


class CertificateOutputs(WireModel):
    """The region: mask and margin, row-major ``[iy][ix]``."""

    certificate: ClosedForm = Field(description="The requested closed form.")
    r_sync_m: float | None = Field(
        description="The paper's synchronization range limit, m; null when there is none."
    )
    r_sync_reason: str | None = Field(None, description="Why r_sync_m is null.")
    safe_fraction: float = Field(description="Share of the corridor's grid points that are certified.")
    paper_safe_fraction: float = Field(description="The same by the paper's conditions, which are not sound.")
    x_m: list[float]
    y_m: list[float]
    mask: list[list[bool]]
    margin_m: list[list[float]] = Field(
        description="certified: least distance to every face for ever where positive. paper: smallest margin, m."
    )


SPEC = ProcessSpec(
    id="certificate",
    title="Closed-form safe-start certificate",
    description=(
        "Certifies every point of a body-frame grid at once: safe fraction of the corridor, mask and margin in metres, "
        "by explicit manoeuvres with a proof; what is not certified is undecided. The paper's conditions, which are "
        "not sound, by certificate=paper; their share stands beside."
    ),
    inputs=CertificateInputs,
    outputs=CertificateOutputs,
    run="safestart.processes.certificate.run:run",
    light=True,
    cost=lambda inputs: _CELL_S * inputs.grid.nx * inputs.grid.ny,
    tables=(Table("cells", ("mask", "margin_m"), axes=("y_m", "x_m")),),
    views=(
        Facts(
            (
                Column("Certified share of the corridor", "safe_fraction"),
                Column("The same by the paper's conditions, not sound", "paper_safe_fraction"),
                Column("Synchronization radius of the paper [m]", "r_sync_m"),
                Column("Why there is none", "r_sync_reason"),
            )
        ),
        Picture(
            "Certified starts",
            "x [m], target's body frame",
            "y [m], target's body frame",
            (Layer("certified", "positive", "cells", "x_m", "y_m", value="margin_m", colour="certified"),),
            equal=True,
        ),
    ),
    keywords=("certificate", "safe-start region"),
    example={"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "grid": {"nx": 31, "ny": 31, "y_max_m": 150}},
)

"""What a sweep answers."""

from __future__ import annotations

from pydantic import Field

from safestart.model.wire_model import WireModel
from safestart.processes.sweep.controllers import Controller
from safestart.processes.sweep.inputs import CertificateName
from safestart.processes.wire import Confusion


class Rates95(WireModel):
    """Wilson intervals of 95 %, null without trials."""

    precision: list[float] | None
    recall: list[float] | None
    false_positive_rate: list[float] | None


class SweepConfusion(Confusion):
    """A certificate (positive: certified) against a controller (actual: flown without violation)."""

    false_positive_rate: float | None = Field(description="fp / (fp + tn).")
    false_positive_share: float | None = Field(description="fp / all, which Iskender et al. calls a rate.")
    wilson_95: Rates95


class DeltaV(WireModel):
    """Impulse of the flights without violation, m/s."""

    flights: int
    mean: float | None
    std: float | None
    least: float | None
    most: float | None


class Cell(WireModel):
    """One cell of Table 3."""

    a_max_m_s2: float
    omega_t_deg_s: float
    r0_m: float
    cases: int
    certified: dict[CertificateName, int] = Field(description="Certified starts by certificate.")
    feasible: dict[Controller, int] = Field(description="Flights without violation by controller.")


class CaseRecord(WireModel):
    """One start, as needed to fly it again."""

    case: int
    omega_t_deg_s: float
    a_max_m_s2: float
    x_m: float
    y_m: float
    margin_m: float | None = Field(description="Least face distance of the flight, or proved bound on it.")
    violated_at_s: float | None
    certified: dict[CertificateName, bool | None]


class SweepOutputs(WireModel):
    """Counts are sums over the shards in their order: the same for any number of workers."""

    cases: int
    evaluated: dict[str, int] = Field(description="Starts each certificate and controller was applied to.")
    undecided: int = Field(description="Starts whose exact answer is UNDECIDED: counted as not certified.")
    confusion: dict[str, dict[str, SweepConfusion]]
    delta_v_m_s: dict[str, DeltaV]
    control_steps: dict[str, int]
    fallbacks: dict[str, int] = Field(description="Steps at which a controller had no admissible command.")
    cells: list[Cell] = Field(description="Table 3; empty unless the distribution is a grid.")
    worst: dict[Controller, list[CaseRecord]] = Field(
        description="Flights that violated although certified, then those closest to it; trajectories.npz has them."
    )
    false_go: list[CaseRecord] = Field(
        description="Starts that the paper's conditions (or certified: never seen) certify and exact proves NO_GO; "
        "false_go_proof.json proves the worst."
    )
    false_go_count: int
    notes: list[str]
    run_s: float = Field(description="Seconds of all parts together.")

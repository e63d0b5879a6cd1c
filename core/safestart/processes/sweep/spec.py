"""sweep: which certified starts really fly, over many starts and controllers (paper 000, Table 3)."""

from __future__ import annotations

from safestart.processes.base import ProcessSpec
from safestart.processes.sharding import Sharding
from safestart.processes.sweep.controllers import CONTROLLERS
from safestart.processes.sweep.inputs import SweepInputs
from safestart.processes.sweep.outputs import SweepOutputs
from safestart.processes.views import Column, Facts, Flights, Matrices, Rows

HERE = "safestart.processes.sweep"

_CASE = (
    Column("case", "case"),
    Column("tumble rate [deg/s]", "omega_t_deg_s"),
    Column("thrust [m/s²]", "a_max_m_s2"),
    Column("x [m]", "x_m"),
    Column("y [m]", "y_m"),
    Column("margin [m]", "margin_m"),
    Column("left after [s]", "violated_at_s"),
    Column("certified", "certified.certified"),
    Column("by the paper's conditions, not sound", "certified.paper"),
    Column("proved by exact", "certified.exact"),
)

SPEC = ProcessSpec(
    id="sweep",
    title="Closed-loop sweep",
    description=(
        "Flies many starts with the chosen controllers against a chosen truth, violations looked for at all times, and "
        "compares with the certificates: Table 3 layout, confusion matrices with intervals, impulse, worst cases. In "
        "parts; the result does not depend on the number of workers."
    ),
    inputs=SweepInputs,
    outputs=SweepOutputs,
    kernels=("flights", "exact answers"),
    sharding=Sharding(
        split=f"{HERE}.split:split",
        shard=f"{HERE}.shard:shard",
        merge=f"{HERE}.merge:merge",
        summary=f"{HERE}.study:summary",
    ),
    views=(
        Matrices(
            "Each certificate against each controller",
            "Rows: the certificate's word on the start. Columns: whether this controller's flight stayed in the "
            "corridor. A flight that is lost from a start with a proof is the controller's failure, not a false "
            "proof. Intervals: Wilson, 95 %.",
            path="confusion.*.*",
            names=("", ""),
            heading="{0}, flown by {1}",
            claims=("certified", "not certified"),
            facts=("stayed", "left"),
            cells=(
                "certified, stayed",
                "certified, lost in flight",
                "stayed, not certified",
                "not certified, left",
            ),
        ),
        Facts(
            (
                Column("Starts", "cases"),
                Column("of which exact leaves undecided", "undecided"),
                Column("certified, most by the paper's conditions, and proved NO_GO", "false_go_count"),
            )
        ),
        Flights("Worst cases", "trajectories.npz", path="worst", columns=_CASE),
        Rows("Certified (by whom: see the columns) and proved NO_GO", "false_go", _CASE, explore=True),
        Rows(
            "Cells",
            "cells",
            (
                Column("tumble rate [deg/s]", "omega_t_deg_s"),
                Column("thrust [m/s²]", "a_max_m_s2"),
                Column("range [m]", "r0_m"),
                Column("starts", "cases"),
                Column("certified", "certified.certified"),
                Column("by the paper's conditions, not sound", "certified.paper"),
                Column("proved by exact", "certified.exact"),
                *(Column(f"stayed: {one.title}", f"feasible.{one.name}") for one in CONTROLLERS.values()),
            ),
        ),
    ),
    keywords=("closed loop", "Monte Carlo", "MPC", "confusion matrix"),
    example={"controllers": ["filter"], "cases_per_cell": 3, "omega_t_deg_s": [1, 3], "a_max_m_s2": [0.1]},
)

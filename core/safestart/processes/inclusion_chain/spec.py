"""inclusion-chain: S_tube, S_ana, S_sync, S_HJpos at one horizon, and where one is not inside the next (eq. 12)."""

from __future__ import annotations

from typing import Annotated, Any, Literal, get_args

from pydantic import Field, model_validator

from safestart.engines.hj.options import HamiltonJacobiInput
from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.views import Column, Facts, Rows
from safestart.processes.wire import DISTINCT, DT_S, LONGEST_S, GridInput, Horizon, ScenarioInput

SetName = Literal[
    "tube",
    "analytical_tube",
    "certified",
    "analytical",
    "synchronize",
    "stay",
    "hj_match",
    "hj_position",
    "exact_position",
]
ALL_SETS: tuple[SetName, ...] = get_args(SetName)
CHAIN: tuple[SetName, ...] = ("certified", "synchronize", "hj_position")
"""Eq. (12) with the sound certificate in the place of S_ana, innermost first."""
PAPER_CHAIN: tuple[SetName, ...] = ("tube", "analytical", "synchronize", "hj_position")
"""Eq. (12) as the paper has it."""


class ChainInputs(ScenarioInput):
    """One operating point, one horizon for every set, and what each set means."""

    grid: GridInput = Field(default_factory=GridInput)
    horizon_s: Horizon = Field(40.0, description="Horizon of every set, s.")
    sets: Annotated[list[SetName], DISTINCT] = Field(
        list(ALL_SETS), min_length=1, max_length=len(ALL_SETS), description="Sets to compute."
    )
    disturbance_m_s2: float = Field(
        0.002, ge=0, le=1, description="Bound on the disturbance that the tube withstands, m/s^2."
    )
    ball_radius_m: float = Field(
        0.5, ge=1e-3, le=1000, description="synchronize: largest distance to the hold point at the end, m."
    )
    rest_speed_m_s: float = Field(
        0.05, ge=1e-4, le=100, description="synchronize: largest speed against the body at the end, m/s."
    )
    match_m_s: float = Field(
        0.5, gt=0, le=100, description="hj_match: largest difference of the velocity from co-rotation, m/s."
    )
    containment_up_to_s: float = Field(
        300.0,
        ge=0,
        le=LONGEST_S,
        multiple_of=DT_S,
        description="Longest horizon at which to look for containment of the certified set, s; 0: do not look.",
    )
    hamilton_jacobi: HamiltonJacobiInput = Field(default_factory=HamiltonJacobiInput)

    @model_validator(mode="after")
    def _affordable(self) -> ChainInputs:
        if self.grid.nx * self.grid.ny > 10_201:
            raise ValueError("grid: nx * ny at most 10201 (101 x 101) for a chain")
        if self.grid.y_max_m <= self.corridor.r_h_m:
            raise ValueError("grid.y_max_m: more than corridor.r_h_m")
        return self


class SetRow(WireModel):
    """One set; counts are null unless ``code`` is ok."""

    name: SetName
    code: str
    message: str
    cells: int | None = Field(description="Cells in the set.")
    undecided_cells: int | None = Field(
        description="Cells that are neither known to be in nor known to be out."
    )
    area_m2: float | None
    run_s: float
    detail: dict[str, Any]


class ChainLink(WireModel):
    """One inclusion of eq. (12), with the sound certificate (``whose``: ours) or as printed (paper)."""

    whose: Literal["ours", "paper"]
    inner: SetName
    outer: SetName
    violation_fraction: float | None
    cells: int | None = Field(description="Cells in the inner set and out of the outer one.")


class ChainCounterExample(WireModel):
    """The cell of the inner set that is farthest out of the outer one."""

    inner: SetName
    outer: SetName
    cells: int
    x_m: float
    y_m: float
    inner_margin_m: float | None
    outer_margin_m: float | None
    evidence: str
    proof: dict[str, Any] | None = Field(
        description="Proof document for `safestart verify` that the start is not in the outer set, or, where the outer "
        "set has none, that it is in the inner one; null where neither has proofs."
    )


class Containment(WireModel):
    """From which horizon on a closed form's set is contained in another."""

    inner: SetName
    outer: SetName
    horizon_s: float | None = Field(description="null: not up to up_to_s, or nothing is certified.")
    up_to_s: float
    cells_never: int | None = Field(description="Certified cells outside at up_to_s (synchronize only).")
    x_m: float | None = Field(description="The start that decides: last to be contained, or never.")
    y_m: float | None
    proof: dict[str, Any] | None = Field(
        description="Proof that this start is never contained up to up_to_s."
    )


class Sliver(WireModel):
    """Starts of a fine grid that a closed form certifies, and those of them that cannot stay."""

    inner: SetName
    certified: int
    cannot_stay: int
    x_m: float | None
    y_m: float | None
    margin_m: float | None
    proof: dict[str, Any] | None


class ChainOutputs(WireModel):
    """Sets, the chain's links, all pairs, counter-examples; masks and margins are in the NPZ artifact."""

    corridor_cells: int
    cell_area_m2: float
    sets: list[SetRow]
    chain: list[ChainLink]
    violation_fraction: dict[str, dict[str, float | None]] = Field(
        description="[inner][outer]: share of the inner set's cells that are out of the outer set; null: empty or "
        "failed."
    )
    counter_examples: list[ChainCounterExample]
    horizon_contained_s: list[Containment]
    slivers: list[Sliver]
    notes: list[str]


SPEC = ProcessSpec(
    id="inclusion-chain",
    title="Inclusion chain of the safe-start sets",
    description=(
        "Computes S_tube, S_ana, S_sync and S_HJpos (Iskender et al., eq. 12) at one horizon on one grid, the sound "
        "certificate in the place of S_ana and S_ana, which is not sound, beside it, with the velocity-aware HJ "
        "target. For every pair: which share of the one lies outside the other, with a counter-example and, where "
        "there is one, its proof; and the horizon at which the certified set is contained."
    ),
    inputs=ChainInputs,
    outputs=ChainOutputs,
    kernels=("level sets", "reachable sets", "exact answers"),
    run="safestart.processes.inclusion_chain.run:run",
    views=(
        Rows(
            "The chain of eq. (12)",
            "chain",
            (
                Column("certificate", "whose"),
                Column("inner", "inner"),
                Column("outer", "outer"),
                Column("share of the inner set outside the outer one", "violation_fraction"),
                Column("cells", "cells"),
            ),
        ),
        Rows(
            "Counter-examples",
            "counter_examples",
            (
                Column("inner", "inner"),
                Column("outer", "outer"),
                Column("cells", "cells"),
                Column("x [m]", "x_m"),
                Column("y [m]", "y_m"),
                Column("margin in the inner set [m]", "inner_margin_m"),
                Column("in the outer one [m]", "outer_margin_m"),
                Column("evidence", "evidence"),
            ),
            explore=True,
        ),
        Rows(
            "Starts of a fine grid that a closed form certifies, and those that cannot stay",
            "slivers",
            (
                Column("certified by", "inner"),
                Column("starts", "certified"),
                Column("of which cannot stay", "cannot_stay"),
                Column("worst at x [m]", "x_m"),
                Column("y [m]", "y_m"),
                Column("margin [m]", "margin_m"),
            ),
        ),
        Facts((Column("Corridor cells", "corridor_cells"),)),
        Rows(
            "Sets",
            "sets",
            (
                Column("set", "name"),
                Column("code", "code"),
                Column("cells", "cells"),
                Column("undecided cells", "undecided_cells"),
                Column("area [m²]", "area_m2"),
                Column("run [s]", "run_s"),
                Column("message", "message"),
            ),
        ),
        Rows(
            "Horizon from which on the certified set is contained",
            "horizon_contained_s",
            (
                Column("inner", "inner"),
                Column("outer", "outer"),
                Column("horizon [s]", "horizon_s"),
                Column("looked up to [s]", "up_to_s"),
                Column("cells never contained", "cells_never"),
                Column("last at x [m]", "x_m"),
                Column("y [m]", "y_m"),
            ),
        ),
    ),
    keywords=("inclusion", "Hamilton-Jacobi", "tube", "synchronization"),
    example={
        "omega_t_deg_s": 3,
        "a_max_m_s2": 0.1,
        "grid": {"nx": 31, "ny": 31, "y_max_m": 150},
        "horizon_s": 40,
    },
)

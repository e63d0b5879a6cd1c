"""approach-trade: what hopping approaches cost and risk over angles, numbers of hops and hold points."""

from __future__ import annotations

from itertools import product
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, field_validator, model_validator

from safestart.hopping.approach import distances
from safestart.hopping.hop_time import fold_deg, hop_phases
from safestart.model.metrics import least_runs
from safestart.model.orbit import EARTH_RADIUS
from safestart.processes.approach_trade.views import VIEWS
from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.hopping.spec import BreachOutput, SigmaInput
from safestart.processes.hopping.wire import MOST_HOPS
from safestart.processes.passive_abort.wire import KeepOut, Orbits, SemiMajorAxis
from safestart.processes.sharding import Sharding
from safestart.processes.wire import DISTINCT, Seed

MOST_APPROACHES = 200
MOST_FLIGHTS = 2_000_000
"""Flights of all approaches, were every level of kappa flown to its end."""

Angle = Annotated[float, Field(ge=0, le=360)]
Distance = Annotated[float, Field(gt=0, le=1e5)]
Hops = Annotated[int, Field(ge=1, le=MOST_HOPS)]
Kappa = Annotated[float, Field(ge=0, le=10)]


class DemandInput(WireModel):
    """What an approach has to meet."""

    breach: float = Field(
        0.01,
        ge=1e-5,
        lt=1,
        description="Probability of an abort breach: the upper end of its interval of 95 % is at most this.",
    )
    error_level: float = Field(
        1.0,
        ge=0,
        le=50,
        description="lambda: every hop is proved to keep out with errors of this many standard deviations.",
    )


class ApproachTradeInputs(WireModel):
    """Every combination of angle, number of hops and hold distance is one approach."""

    angles_deg: Annotated[list[Angle], Field(min_length=1, max_length=60), DISTINCT] = Field(
        [0.0, 20.0, 40.0, 60.0, 90.0, 110.0, 120.0, 130.0, 140.0],
        description="Lines from the target: 0 V-bar ahead, 90 R-bar below, deg; up to the fold of every hop.",
    )
    hops: Annotated[list[Hops], Field(min_length=1, max_length=10), DISTINCT] = Field(
        [5], description="Numbers of hops."
    )
    holds_m: Annotated[list[Distance], Field(min_length=1, max_length=10), DISTINCT] = Field(
        [100.0], description="Distances of the hold point, m."
    )
    start_m: Distance = Field(2000.0, description="Distance at the start, m.")
    semi_major_axis_m: SemiMajorAxis = 8.1e6
    inclination_deg: float = Field(0.0, ge=0, le=180, description="Inclination of the target's orbit, deg.")
    eccentricity: float = Field(
        0.0,
        ge=0,
        lt=1,
        description="Of the target's orbit, flown from its perigee; plan and proof are for a circle.",
    )
    keep_out_m: KeepOut = 50.0
    abort_orbits: Orbits = 2.0
    sigma: SigmaInput = Field(default_factory=lambda: SigmaInput.model_validate({}))
    demand: DemandInput = Field(default_factory=lambda: DemandInput.model_validate({}))
    kappas: Annotated[list[Kappa], Field(max_length=8), DISTINCT] = Field(
        [2.0, 3.0, 3.5, 4.0],
        description="Tightenings of the barrier to try, standard deviations of the drift, where the demanded risk is "
        "not met without one; empty: none.",
    )
    runs: int = Field(400, ge=1, le=20_000, description="Flights of each approach, and of each tightening.")
    seed: Seed = 0

    @field_validator("angles_deg", "hops", "holds_m", "kappas")
    @classmethod
    def _ordered(cls, value: list[float]) -> list[float]:
        return sorted(value)

    @model_validator(mode="after")
    def _flies(self) -> ApproachTradeInputs:
        if not max(self.holds_m) < self.start_m:
            raise ValueError("start_m: more than every one of holds_m, hops lead towards the target")
        if min(self.holds_m) < self.keep_out_m:
            raise ValueError("holds_m: at least keep_out_m, a hold point lies outside the keep-out sphere")
        if self.semi_major_axis_m * (1.0 - self.eccentricity) <= EARTH_RADIUS:
            raise ValueError(f"eccentricity: a perigee above the Earth's surface, {EARTH_RADIUS:g} m")
        count = len(self.angles_deg) * len(self.hops) * len(self.holds_m)
        if count > MOST_APPROACHES:
            raise ValueError(
                f"angles_deg: at most {MOST_APPROACHES} combinations with hops and holds_m, these are {count}"
            )
        most = MOST_FLIGHTS // (count * (1 + 2 * len(self.kappas)))
        if self.runs > most:
            raise ValueError(f"runs: at most {most} for {count} approaches and {len(self.kappas)} kappas")
        least = least_runs(self.demand.breach)
        if self.runs < least:
            raise ValueError(
                f"runs: at least {least}, as with fewer not even none with a breach shows a share of at most "
                f"{self.demand.breach:g} with 95 % confidence"
            )
        self._before_the_folds()
        return self

    def _before_the_folds(self) -> None:
        angles = np.array(self.angles_deg)
        for hops, hold in product(self.hops, self.holds_m):
            d = distances(self.start_m, hold, hops)
            rho = float(d[1] / d[0])
            if rho > 1.0 - 1e-6:
                raise ValueError(
                    f"hops: so few that each leaves at most 1 - 1e-6 of its distance, not {hops}"
                )
            phases = hop_phases(angles, np.full(len(angles), rho))
            if np.isnan(phases).any():
                raise ValueError(
                    f"angles_deg: angles (modulo 180) up to {fold_deg(rho):.2f} deg, the fold of the hops that leave "
                    f"{rho:.4g} of the distance ({hops} hops from {self.start_m:g} to {hold:g} m); beyond it there is "
                    f"no such hop, and {angles[np.isnan(phases)][0]:g} deg lies there"
                )


Met = Literal["MET", "REMEDIED", "UNDECIDED", "NOT_MET"]


class TighteningOutput(WireModel):
    """The least kappa whose flights show the demanded risk, and what they cost; its flights are others than those that
    chose it."""

    kappa: float
    breach_low: float
    breach_high: float
    breaches: int
    fuel_1norm_m_s: float = Field(description="Mean, flown.")
    fuel_2norm_m_s: float = Field(description="Mean, flown.")
    hold_m: float = Field(description="Mean distance at the end.")


class AwayOutput(WireModel):
    """The approach whose hops drift away by as little as the demanded error level takes, as planned."""

    drift_m_per_orbit: float = Field(description="The most that was added to the drift of any hop.")
    orbits: float
    fuel_1norm_m_s: float
    fuel_2norm_m_s: float
    lambda_: float = Field(alias="lambda", description="Proved for this plan.")


class ApproachOutput(WireModel):
    """One approach: its cost as planned, its risk as flown, its proof, and what it takes to meet the demand."""

    angle_deg: float
    hops: int
    hold_m: float
    verdict: Met = Field(
        description="MET: by the plan without a barrier; REMEDIED: with tightening or away; UNDECIDED: the interval "
        "holds the demanded risk, and no kappa shows it; NOT_MET."
    )
    risk: Met = Field(description="The demand on the risk alone.")
    level: Met = Field(description="The demand on the error level alone.")
    orbits: float
    time_s: float
    fuel_1norm_m_s: float = Field(description="Planned.")
    fuel_2norm_m_s: float = Field(description="Planned.")
    breach: BreachOutput = Field(
        description="Without a barrier; per_hop is empty. Lost runs count as breaches in probability and high."
    )
    lost: int = Field(description="Runs in which guidance found no hop from where it believed to be.")
    lambda_: float = Field(alias="lambda", description="Greatest error level that is proved, CWH motion.")
    pareto: bool = Field(
        description="No other approach needs at most its fuel (2-norm) at an error level at least as high."
    )
    tightening: TighteningOutput | None
    away: AwayOutput | None


class ApproachFindingOutput(WireModel):
    """A statement about the approaches; HELD with its figures, or BROKEN by them."""

    claim: str
    verdict: Literal["HELD", "BROKEN", "UNDECIDED"]
    angle_deg: float | None
    hops: int | None
    hold_m: float | None
    fuel_1norm_m_s: float | None
    fuel_2norm_m_s: float | None
    lambda_: float | None = Field(alias="lambda")
    breach_high: float | None
    less_fuel_1norm_percent: float | None = Field(description="Than the R-bar with its hops and hold point.")
    less_fuel_2norm_percent: float | None


class FrontOutput(WireModel):
    """An approach that no other one betters in both fuel and error level."""

    angle_deg: float
    hops: int
    hold_m: float
    fuel_2norm_m_s: float
    lambda_: float = Field(alias="lambda")


class ApproachTradeOutputs(WireModel):
    """Findings, the front, then every approach."""

    findings: list[ApproachFindingOutput]
    front: list[FrontOutput] = Field(description="By fuel, ascending.")
    approaches: list[ApproachOutput]
    notes: list[str]


_HERE = "safestart.processes.approach_trade"
_FLIGHT_S = 0.02
"""A flight with its aborts; kappas come on top where the demand is not met."""

SPEC = ProcessSpec(
    id="approach-trade",
    title="Hopping approaches, priced by their safety",
    description=(
        "Hopping approaches over angles, numbers of hops and hold points: time, fuel, the probability of an abort "
        "breach as flown about the true Earth with its interval, the error level that is proved, and the least "
        "tightening of the barrier or drift away that meets a demanded risk and level. A part per approach."
    ),
    inputs=ApproachTradeInputs,
    outputs=ApproachTradeOutputs,
    sharding=Sharding(
        split=f"{_HERE}.study:split",
        shard=f"{_HERE}.run:shard",
        merge=f"{_HERE}.run:merge",
        summary=f"{_HERE}.study:summary",
    ),
    cost=lambda inputs: (
        _FLIGHT_S * inputs.runs * len(inputs.angles_deg) * len(inputs.hops) * len(inputs.holds_m)
    ),
    views=VIEWS,
    keywords=("hopping", "trade study", "Pareto", "abort", "V-bar", "R-bar"),
    example={"angles_deg": [0, 90, 120, 130], "runs": 80, "demand": {"breach": 0.05}, "kappas": [3.5, 5]},
)

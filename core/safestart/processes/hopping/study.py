"""The plan of an approach, and what is counted over those flown. Light to import: the service shows partial results."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from safestart.campaign.combined import Each
from safestart.campaign.design import Repeated
from safestart.campaign.rates import Share
from safestart.campaign.spread import Spread
from safestart.campaign.study import Study
from safestart.campaign.table import Column, Kind
from safestart.hopping.approach import Approach, approach, mean_motion_of, without_round_off
from safestart.processes.hopping.spec import PER_SHARD, HoppingInputs

NOTES = [
    "The plan is in CWH motion about a circular orbit, and so is the proof unless proof_model says otherwise; the "
    "study flies about the true Earth with J2.",
    "A breach: thrusters that die right after a hop's impulse, and a drift of abort_orbits that enters the sphere. The "
    "drift from the hold point, after the stop, is counted apart.",
    "The proof's box has one standard deviation in every direction, at every burn; lambda is its greatest multiple.",
]


def plan_of(inputs: HoppingInputs) -> Approach:
    """The approach; raises ``InvalidInput`` for an angle past a hop's fold."""
    n = mean_motion_of(inputs.semi_major_axis_m)
    return approach(n, inputs.angle_deg, inputs.start_m, inputs.hold_m, inputs.hops, inputs.gamma)


def study_of(inputs: HoppingInputs) -> Study:
    """Every case is one approach."""
    hops = [f"breach_{k}" for k in range(inputs.hops)]
    numbers = ("fuel_1norm_m_s", "fuel_2norm_m_s", "hold_m", "closest_m")
    flags = ("breach", "stop_breach", "barrier_failed", *hops)
    columns = [
        *(Column(name, Kind.FLAG) for name in flags),
        *(Column(name, Kind.NUMBER) for name in numbers),
    ]
    tally = Each({**{name: Share(name) for name in flags}, **{name: Spread(name) for name in numbers}})
    return Study(Repeated(inputs.runs), columns, tally, PER_SHARD, inputs.seed, inputs.runs)


def split(inputs: HoppingInputs) -> list[dict[str, Any]]:
    """Shards of up to 100 approaches; refuses a plan that does not exist."""
    plan_of(inputs)
    return study_of(inputs).parts(inputs.model_dump(mode="json"))


def summary(inputs: HoppingInputs, documents: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """Plan and study of the given shards; the proof comes with the last one."""
    total = study_of(inputs).total(documents)
    return {
        "plan": plan_document(plan_of(inputs)),
        "study": _study(inputs, total.said) if total.shards else None,
        "proof": None,
        "notes": NOTES,
    }


def plan_document(plan: Approach) -> dict[str, Any]:
    """The plan on the wire."""
    impulses = without_round_off(plan.impulses).tolist()
    return {
        "hops": [
            {
                "start_m": hop.start,
                "end_m": hop.end,
                "rho": hop.rho,
                "orbits": hop.orbits,
                "impulse_m_s": impulse,
            }
            for hop, impulse in zip(plan.hops, impulses, strict=False)
        ],
        "stop_m_s": impulses[-1],
        "orbits": plan.orbits,
        "fuel_1norm_m_s": plan.fuel_1norm,
        "fuel_2norm_m_s": plan.fuel_2norm,
    }


def _study(inputs: HoppingInputs, said: dict[str, Any]) -> dict[str, Any]:
    return {
        "breach": _breach(said["breach"], [said[f"breach_{k}"] for k in range(inputs.hops)]),
        "stop_breach": _breach(said["stop_breach"], []),
        "fuel_1norm_m_s": said["fuel_1norm_m_s"]["mean"],
        "fuel_2norm_m_s": said["fuel_2norm_m_s"]["mean"],
        "hold_m": said["hold_m"]["mean"],
        "hold_std_m": said["hold_m"]["std"],
        "barrier_failed": said["barrier_failed"]["count"],
    }


def _breach(share: dict[str, Any], hops: list[dict[str, Any]]) -> dict[str, Any]:
    low, high = share["wilson_95"]
    return {
        "probability": share["share"],
        "low": low,
        "high": high,
        "count": share["count"],
        "runs": share["cases"],
        "per_hop": [hop["share"] for hop in hops],
    }

"""Run hop-plan: plan, prove every hop in NumPy, sample drifts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safestart.hopping.approach import Approach, approach, mean_motion_of, without_round_off
from safestart.hopping_safety.fan import drifts_of, worst_drift
from safestart.hopping_safety.quick_document import document_of
from safestart.hopping_safety.quick_proof import Bounds, error_level, hop_bounds, position_rows, start_bounds
from safestart.missed_burn.plan import Errors
from safestart.model.scenario import Floats
from safestart.processes.base import Artifact, ProcessOutput
from safestart.processes.hop_plan.spec import HopPlanInputs
from safestart.processes.hopping.study import plan_document
from safestart.records.comparable import canonical
from safestart.runtime.progress import Context

NOTES = [
    "Plan, proofs and drifts are in CWH motion about a circular orbit; J2 and the nonlinear terms are not in them. The "
    "process hopping flies the approach about the true Earth, passive-abort proves it there.",
    "Where the verdict is PROVED, proof.json holds the proof of all hops and of the drift from the start; safestart "
    "verify checks it in ball arithmetic.",
    "The proofs' box has one standard deviation in every direction, at every burn; lambda is its greatest multiple.",
]
_PER_HOP = 60
_PER_ORBIT = 60
_MOST_SAMPLES = 300


def run(inputs: HopPlanInputs, context: Context) -> ProcessOutput:
    """Raises ``InvalidInput`` for an angle past a hop's fold."""
    n = mean_motion_of(inputs.semi_major_axis_m)
    plan = approach(n, inputs.angle_deg, inputs.start_m, inputs.hold_m, inputs.hops, inputs.gamma)
    sigma, horizon = inputs.sigma, inputs.abort_orbits * math.tau / n
    at, fast = sigma.position_m, sigma.velocity_m_s
    errors = Errors((at, at, at), (fast, fast, fast), sigma.thrust_share, math.radians(sigma.thrust_deg))
    context.step(0, 3, "proof")
    begun = start_bounds(plan, inputs.keep_out_m, horizon, errors)
    found = hop_bounds(plan, inputs.keep_out_m, horizon, errors)
    proofs, drifts = _hops(inputs, plan, horizon, errors, found)
    context.step(1, 3, "error level")
    exact = not any((at, fast, sigma.thrust_share, sigma.thrust_deg))
    level = None if exact else error_level(plan, inputs.keep_out_m, horizon, errors)
    words = {proof["verdict"] for proof in proofs} | (
        {"UNKNOWN"} if begun.least < inputs.keep_out_m else set()
    )
    verdict = next(word for word in ("VIOLATED", "UNKNOWN", "PROVED") if word in words)
    document, artifacts = None, []
    if verdict == "PROVED":
        document = document_of(plan, inputs.keep_out_m, horizon, errors, begun, found)
        artifacts.append(Artifact("proof.json", "application/json", canonical(document).encode()))
    return ProcessOutput(
        {
            "verdict": verdict,
            "lambda": level,
            "plan": plan_document(plan),
            "proofs": proofs,
            "burns": _burns(plan),
            "path": _path(plan).round(3).tolist(),
            "drifts": drifts,
            "document": document if inputs.document else None,
            "notes": NOTES,
        },
        tuple(artifacts),
    )


def _hops(
    inputs: HopPlanInputs, plan: Approach, horizon: float, errors: Errors, found: list[Bounds]
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """What is proved of each hop, and drifts after it."""
    samples = min(math.ceil(_PER_ORBIT * inputs.abort_orbits) + 1, _MOST_SAMPLES)
    rows = position_rows(plan.mean_motion, np.linspace(0.0, horizon, samples))[:, :2]
    proofs, drifts = [], []
    for k, bounds in enumerate(found):
        until = max(horizon, plan.hops[k].time)
        worst, near = worst_drift(plan, k, errors, until, bounds.when, bounds.towards)
        kept = bounds.least >= inputs.keep_out_m
        word = "PROVED" if kept else "VIOLATED" if near < inputs.keep_out_m else "UNKNOWN"
        proofs.append({"hop": k + 1, "verdict": word, "least_distance_m": bounds.least, "nearest_m": near})
        states = drifts_of(plan, k, errors)
        named = [("planned", states[0]), *(("within errors", state) for state in states[1:])]
        for member, state in [*named, ("worst found", worst)]:
            path = (rows @ state).round(2)
            drifts.append(
                {
                    "hop": k + 1,
                    "member": member,
                    "verdict": word,
                    "radial_m": path[:, 0].tolist(),
                    "along_track_m": path[:, 1].tolist(),
                }
            )
    return proofs, drifts


def _burns(plan: Approach) -> list[dict[str, Any]]:
    positions, impulses = (without_round_off(v) for v in (plan.states()[:, :3], plan.impulses))
    return [
        {
            "burn": k + 1,
            "time_s": time,
            "distance_m": float(np.linalg.norm(position)),
            "position_m": position.tolist(),
            "impulse_m_s": impulse,
        }
        for k, (time, position, impulse) in enumerate(
            zip(plan.times.tolist(), positions, impulses.tolist(), strict=True)
        )
    ]


def _path(plan: Approach) -> Floats:
    """Radial and along-track (K, 2), m, of all hops, one after the other."""
    paths = [
        position_rows(plan.mean_motion, np.linspace(0.0, hop.time, _PER_HOP))[:, :2] @ hop.left_with
        for hop in plan.hops
    ]
    return np.concatenate(paths)

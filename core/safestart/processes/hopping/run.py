"""Run hopping: one shard's flights; plan, study and proof of all of them, with pictures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from safestart.campaign.case import Case
from safestart.campaign.part import Part
from safestart.campaign.records import MEDIA_TYPE
from safestart.control.hopping import Hopping
from safestart.hopping.approach import Approach
from safestart.hopping.barrier import Noise
from safestart.hopping_flights.fly import HoppingFlight, World, fly
from safestart.missed_burn.document import document_of
from safestart.missed_burn.earth.motion import Earth
from safestart.missed_burn.plan import Errors, Plan, Question
from safestart.missed_burn.prove import Proof, Verdict, greatest_scale, prove
from safestart.processes.base import Artifact, ProcessOutput
from safestart.processes.hopping.plots import flights_picture, plan_picture
from safestart.processes.hopping.spec import HoppingInputs
from safestart.processes.hopping.study import plan_of, study_of, summary
from safestart.processes.passive_abort.second_look import Look, looked_at, told_of, withdrawn
from safestart.records.comparable import canonical
from safestart.runtime.progress import Context

_SHOWN = 50
"""Flights in the picture: as many as in the paper's."""


def world_of(inputs: HoppingInputs) -> World:
    """The approach in SI."""
    sigma = inputs.sigma
    noise = Noise(sigma.position_m, sigma.velocity_m_s, sigma.thrust_share, math.radians(sigma.thrust_deg))
    return World(
        semi_major_axis=inputs.semi_major_axis_m,
        eccentricity=inputs.eccentricity,
        inclination=math.radians(inputs.inclination_deg),
        angle_deg=inputs.angle_deg,
        start=inputs.start_m,
        hold=inputs.hold_m,
        hops=inputs.hops,
        gamma=inputs.gamma,
        keep_out=inputs.keep_out_m,
        barrier=inputs.barrier,
        kappa=inputs.kappa,
        noise=noise,
        abort_orbits=inputs.abort_orbits,
        drag=inputs.drag_m_s2,
    )


def shard(part: dict[str, Any], context: Context) -> Part:
    """Fly the part's approaches."""
    inputs = HoppingInputs.model_validate(part["inputs"])
    world = world_of(inputs)
    steer = world.controller()

    def simulate(case: Case, _: Context) -> dict[str, Any]:
        return outcome(world, flown(world, case, steer))

    return study_of(inputs).simulated(part, simulate, context, "approach")


def flown(world: World, case: Case, steer: Hopping, *, aborts: bool = True) -> HoppingFlight:
    """One approach of the study; its numbers depend on seed and case alone."""
    return fly(world, case.generator(), steer, aborts=aborts)


def outcome(world: World, flight: HoppingFlight) -> dict[str, Any]:
    """What is kept of an approach."""
    entered = flight.closest < world.keep_out
    return {
        "breach": bool(entered[:-1].any()),
        "stop_breach": bool(entered[-1]),
        "barrier_failed": not flight.feasible,
        **{f"breach_{k}": bool(entered[k]) for k in range(world.hops)},
        "fuel_1norm_m_s": flight.fuel_1norm,
        "fuel_2norm_m_s": flight.fuel_2norm,
        "hold_m": flight.hold,
        "closest_m": float(flight.closest[:-1].min()),
    }


def merge(inputs: HoppingInputs, parts: Sequence[Part], context: Context) -> ProcessOutput:
    """The document with the proof; pictures; the records of all approaches."""
    document = summary(inputs, [part.document for part in parts])
    plan = plan_of(inputs)
    context.step(0, 3, "proof")
    proof, level = proved(inputs, plan)
    look: Look | None = None
    evidence = None
    if proof.verdict is Verdict.PROVED:
        evidence = document_of(proof)
        look = looked_at(evidence)
        if look.refused:
            # A prover whose document is refused is not believed about other scales of the errors, either.
            proof, level, evidence = withdrawn(proof), None, None
        document["notes"] = [*document["notes"], *told_of(look)]
    document["proof"] = {
        "verdict": proof.verdict.value,
        "checked": None if look is None else look.checked,
        "model": inputs.proof_model,
        "lambda": level,
        "least_distance_m": [finding.least for finding in proof.findings if finding.case.kind == "made"],
    }
    context.step(1, 3, "pictures")
    world = world_of(inputs)
    steer = world.controller()
    shown = [flown(world, Case(k, inputs.seed), steer) for k in range(min(inputs.runs, _SHOWN))]
    artifacts = [
        plan_picture(inputs, plan, proof),
        flights_picture(inputs, world, shown, document["study"]["breach"]),
        Artifact("approaches.parquet", MEDIA_TYPE, study_of(inputs).recorded(parts)),
    ]
    if evidence is not None:
        artifacts.append(Artifact("proof.json", "application/json", canonical(evidence).encode()))
    return ProcessOutput(document, tuple(artifacts))


def proved(inputs: HoppingInputs, plan: Approach) -> tuple[Proof, float | None]:
    """The proof of the plan's hops with a box of one sigma, and lambda (None where there are no errors)."""
    sigma = inputs.sigma
    at, fast = sigma.position_m, sigma.velocity_m_s
    errors = Errors((at, at, at), (fast, fast, fast), sigma.thrust_share, math.radians(sigma.thrust_deg))
    flight = Plan.of(
        plan.mean_motion, plan.states()[0].tolist(), plan.times[:-1].tolist(), plan.impulses[:-1]
    )
    horizon = inputs.abort_orbits * math.tau / plan.mean_motion
    radius = inputs.semi_major_axis_m if inputs.proof_model == "nonlinear" else None
    earth = None
    if inputs.proof_model == "earth":
        # The burns are planned anew from estimates, so the box lies around the planned states.
        tilt = math.radians(inputs.inclination_deg)
        before = plan.states()[:-1]
        earth = Earth.of(flight, inputs.semi_major_axis_m, inputs.eccentricity, tilt, before=before)
    question = Question(flight, inputs.keep_out_m, horizon, errors, radius=radius, earth=earth)
    exact = not any((at, fast, sigma.thrust_share, sigma.thrust_deg))
    return prove(question), None if exact else greatest_scale(question)

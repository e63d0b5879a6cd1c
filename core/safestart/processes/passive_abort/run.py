"""Run passive-abort: prove, find the error level, draw."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from safestart.missed_burn.document import document_of
from safestart.missed_burn.earth.motion import Earth
from safestart.missed_burn.plan import Plan, Question
from safestart.missed_burn.prove import Proof, Verdict, greatest_scale, prove
from safestart.missed_burn.replay import MemberFlight
from safestart.processes.base import Artifact, ProcessOutput
from safestart.processes.output import Undrawn
from safestart.processes.passive_abort.filed import left_out, resolved
from safestart.processes.passive_abort.plots import picture
from safestart.processes.passive_abort.question import plain_question
from safestart.processes.passive_abort.second_look import Look, looked_at, told_of, withdrawn
from safestart.processes.passive_abort.spec import PassiveAbortInputs
from safestart.processes.wire import finite
from safestart.records.comparable import canonical
from safestart.runtime.progress import Context

NOTES = {
    "linear": "model: linear. The verdict speaks about the CWH motion, round-off included; what this motion leaves out "
    "(the nonlinear terms, J2, drag) is not in it.",
    "nonlinear": "model: nonlinear. The verdict speaks about two point masses, the target on a circular orbit, "
    "round-off included; J2 and drag are not in it. A gap here may be that of the bound on the nonlinear terms.",
    "earth": "model: earth. The verdict speaks about both bodies about the Earth with J2, the target on its given "
    "orbit, the chaser's states before burns within the errors of those given; drag and other forces are not in it.",
}


def run(inputs: PassiveAbortInputs, context: Context) -> ProcessOutput:
    """Verdict, cases, document or counter-example, picture."""
    inputs, filed = resolved(inputs)
    question = question_of(inputs)
    proof = prove(question, tick=lambda k, of: context.step(0.6 * k / of, 1.0, "cases"))
    artifacts: list[Artifact | Undrawn] = []
    told: list[str] = []
    look: Look | None = None
    if proof.verdict is Verdict.PROVED:
        context.step(0.6, 1.0, "checking the proof")
        document = document_of(proof)
        look = looked_at(document)
        if look.refused:
            proof = withdrawn(proof)
        else:
            artifacts.append(Artifact("proof.json", "application/json", canonical(document).encode()))
        told = told_of(look)
    # A prover whose document is refused is not believed about other scales of the errors, either.
    level = greatest_scale(question) if inputs.error_level and not (look and look.refused) else None
    context.step(0.9, 1.0, "picture")
    artifacts.insert(0, picture(proof))
    flown = proof.counter_example
    return ProcessOutput(
        {
            "verdict": proof.verdict.value,
            "checked": None if look is None else look.checked,
            "model": inputs.model,
            "least_distance_m": proof.least,
            "gap_m": proof.gap,
            "error_level": level,
            "read": filed,
            "cases": cases_of(proof),
            "counter_example": None if flown is None else flown_document(flown, question),
            "notes": [NOTES[inputs.model], *told, *left_out(inputs, filed)],
        },
        tuple(artifacts),
    )


def question_of(inputs: PassiveAbortInputs) -> Question:
    """The question in SI."""
    question = plain_question(inputs)
    if inputs.model != "earth":
        return question
    return replace(question, earth=earth_of(inputs, question.plan))


def earth_of(inputs: PassiveAbortInputs, plan: Plan) -> Earth:
    """The target's orbit and the states before the burns."""
    tilt, perigee, anomaly = (
        math.radians(a)
        for a in (inputs.inclination_deg, inputs.argument_of_perigee_deg, inputs.true_anomaly_deg)
    )
    states = inputs.states
    before = None
    if states is not None:
        before = np.array([[*state.position_m, *state.velocity_m_s] for state in states])
    return Earth.of(plan, inputs.semi_major_axis_m, inputs.eccentricity, tilt, perigee, anomaly, before)


def cases_of(proof: Proof) -> list[dict[str, Any]]:
    """Distances of every burn and failure, over all pieces. A burn is missed if the one before was the last."""
    out: dict[tuple[int, str], dict[str, Any]] = {}
    for finding in proof.findings:
        case = finding.case
        # Drifting after a completed burn means missing the next one.
        missed = case.kind in ("start", "made")
        key = (case.burn + 1 if missed else case.burn, _failure(case.kind))
        row = out.setdefault(
            key,
            {
                "burn": key[0],
                "failure": key[1],
                "least_distance_m": finding.least,
                "nearest_m": None,
                "when_s": None,
            },
        )
        row["least_distance_m"] = min(row["least_distance_m"], finding.least)
        if math.isfinite(finding.nearest) and (
            row["nearest_m"] is None or finding.nearest < row["nearest_m"]
        ):
            row["nearest_m"], row["when_s"] = finding.nearest, finite(finding.when)
    return [out[key] for key in sorted(out)]


def _failure(kind: str) -> str:
    """What a kind of case is called on the wire."""
    return {"start": "missed", "made": "missed", "cut": "cut short"}.get(kind, kind)


def flown_document(flown: MemberFlight, question: Question) -> dict[str, Any]:
    """A counter-example on the wire."""
    missed = flown.kind in ("start", "made")
    return {
        "burn": flown.burn + 1 if missed else flown.burn,
        "failure": _failure(flown.kind),
        "begin_s": flown.begin,
        "position_m": flown.start[:3].tolist(),
        "velocity_m_s": flown.start[3:].tolist(),
        "burns": [
            {"time_s": time, "impulse_m_s": impulse, "duration_s": duration}
            for time, impulse, duration in zip(
                flown.times.tolist(), flown.impulses.tolist(), flown.durations.tolist(), strict=True
            )
        ],
        "push_m_s2": flown.push.tolist(),
        "push_s": flown.push_for,
        "look_s": flown.look,
        "distance_m": min(flown.distance(question.radius, zone) for zone in question.zones),
    }

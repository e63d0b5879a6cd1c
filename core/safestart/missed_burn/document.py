"""The proof document of a plan (schema ``safestart-abort-proof/1``); :mod:`safestart.proofs.abort` checks it."""

from __future__ import annotations

from typing import Any

from safestart.dynamics.two_body import J2
from safestart.errors import Conflict
from safestart.missed_burn.plan import Question
from safestart.missed_burn.prove import Proof, Verdict
from safestart.model.orbit import EARTH_RADIUS, MU
from safestart.proofs.statement import digest_of

SCHEMA = "safestart-abort-proof/1"


def document_of(proof: Proof) -> dict[str, Any]:
    """The document of a PROVED plan; raises ``Conflict`` for any other verdict."""
    if proof.verdict is not Verdict.PROVED:
        raise Conflict(f"a proof document needs the verdict PROVED, this one is {proof.verdict.value}")
    document: dict[str, Any] = {
        "schema": SCHEMA,
        "verdict": "PROVED",
        "least_distance_m": proof.least,
        "question": question_document(proof.question),
        "cases": [
            {
                "kind": finding.case.kind,
                "burn": finding.case.burn,
                "first_s": finding.case.first,
                "last_s": finding.case.last,
                "cells": finding.cells.tolist(),
                **({"radii_m": finding.trials.tolist()} if len(finding.trials) else {}),
            }
            for finding in proof.findings
        ],
    }
    document["digest"] = digest_of(document)
    return document


def question_document(question: Question) -> dict[str, Any]:
    """The question in the document's form."""
    plan, errors, failures = question.plan, question.errors, question.failures
    return {
        **_model(question),
        "mean_motion_rad_s": plan.mean_motion,
        "start": {"position_m": list(plan.start[:3]), "velocity_m_s": list(plan.start[3:])},
        "burns": [{"time_s": burn.time, "impulse_m_s": list(burn.impulse)} for burn in plan.burns],
        "keep_out_m": question.keep_out,
        "horizon_s": question.horizon,
        "errors": {
            "position_m": list(errors.position),
            "velocity_m_s": list(errors.velocity),
            "thrust_share": errors.thrust_share,
            "thrust_rad": errors.thrust_angle,
            "at_each_burn": errors.at_each_burn,
        },
        "failures": {
            "late_s": failures.late,
            "partial": failures.partial,
            "stuck_s": failures.stuck,
            "acceleration_m_s2": failures.acceleration,
            "misdirected_rad": failures.misdirected,
        },
    }


def _model(question: Question) -> dict[str, Any]:
    if question.earth is not None:
        target = question.earth.target
        return {
            "model": "earth",
            "target": {
                "position_m": list(target[:3]),
                "velocity_m_s": list(target[3:]),
                "mu_m3_s2": MU,
                "j2": J2,
                "earth_radius_m": EARTH_RADIUS,
            },
            "before": [
                {"position_m": list(state[:3]), "velocity_m_s": list(state[3:])}
                for state in question.earth.before
            ],
        }
    if question.radius is not None:
        return {"model": "nonlinear", "semi_major_axis_m": question.radius}
    return {"model": "linear"}

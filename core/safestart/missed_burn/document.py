"""The proof document of a plan (schema ``safestart-abort-proof/1``); :mod:`safestart.proofs.abort` checks it."""

from __future__ import annotations

from typing import Any

from safestart.errors import Conflict
from safestart.missed_burn.plan import Question
from safestart.missed_burn.prove import Proof, Verdict
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
        "question": asked(proof.question),
        "cases": [
            {
                "kind": finding.case.kind,
                "burn": finding.case.burn,
                "first_s": finding.case.first,
                "last_s": finding.case.last,
                "cells": finding.cells.tolist(),
                **({"radii_m": finding.trials.tolist()} if proof.question.radius is not None else {}),
            }
            for finding in proof.findings
        ],
    }
    document["digest"] = digest_of(document)
    return document


def asked(question: Question) -> dict[str, Any]:
    """The question in the document's form."""
    plan, errors, failures = question.plan, question.errors, question.failures
    return {
        "model": "linear" if question.radius is None else "nonlinear",
        **({} if question.radius is None else {"semi_major_axis_m": question.radius}),
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

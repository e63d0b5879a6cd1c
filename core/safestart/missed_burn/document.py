"""The proof document of a plan; :mod:`safestart.proofs.abort` checks it."""

from __future__ import annotations

from typing import Any

from safestart.errors import Conflict
from safestart.missed_burn.plan import Question
from safestart.missed_burn.prove import Finding, Proof, Verdict
from safestart.missed_burn.question_document import sealed, wider


def document_of(proof: Proof) -> dict[str, Any]:
    """The document of a PROVED plan; raises ``Conflict`` for any other verdict."""
    if proof.verdict is not Verdict.PROVED:
        raise Conflict(f"a proof document needs the verdict PROVED, this one is {proof.verdict.value}")
    wide = wider(proof.question)
    return sealed(
        proof.question, proof.least, [_case(proof.question, finding, wide) for finding in proof.findings]
    )


def _case(question: Question, finding: Finding, wide: bool) -> dict[str, Any]:
    case = finding.case
    out: dict[str, Any] = {
        "kind": case.kind,
        "burn": case.burn,
        "first_s": case.first,
        "last_s": case.last,
        "cells": finding.cells.tolist(),
    }
    if wide:
        on = case.thrust.first, case.thrust.last
        if case.kind == "stuck":
            # first_s and last_s say how long it goes on afterwards.
            on = (question.plan.burns[case.burn].duration,) * 2
        out |= {"on_first_s": on[0], "on_last_s": on[1], "zone": finding.zone}
        if question.earth is not None:
            out["reference"] = case.share
    if len(finding.trials):
        out["radii_m"] = finding.trials.tolist()
    return out

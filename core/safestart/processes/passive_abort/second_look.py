"""A proof is looked at by the independent checker before it is handed out, where that takes seconds, not minutes.

How long it takes is estimated from counts alone: the answer to a question is the same on every machine, however busy.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from safestart.missed_burn.prove import Proof, Verdict

BUDGET = 10.0
"""s: a document that takes the checker longer, by the estimate, is handed out unchecked, and the answer says so."""
_CASE, _BENT_CASE, _CELL = 0.004, 0.03, 1.5e-4
_EARTH_CASE, _EARTH_CELL = 0.012, 1e-3
_ORBIT, _REFERENCE = 0.4, 0.25
"""s on one core: a case and a cell, in the linear, the nonlinear and the true motion; there also an orbit of an
enclosed course, and the rest of what a reference takes."""


UNCHECKED = (
    f"checked: false. The independent checker would need more than about {BUDGET:g} s for it and was not asked; "
    "safestart verify asks it."
)
REFUSED = (
    "verdict: UNKNOWN, as the independent checker refuses the proof: {reason}. This is a fault of the prover; nothing "
    "that it found counts as proved."
)


@dataclass(frozen=True, slots=True)
class Look:
    """Whether the checker has looked at a document; ``refused``: why it does not accept it, empty where it does."""

    checked: bool
    refused: str = ""


def looked_at(document: Mapping[str, Any]) -> Look:
    """The checker's verdict on a document, if it is within the budget."""
    if seconds_of(document) > BUDGET:
        return Look(False)
    from safestart.proofs.abort.check import check
    from safestart.proofs.strict import ProofRejected

    try:
        check(document)
    except ProofRejected as error:
        return Look(True, str(error))
    return Look(True)


def told_of(look: Look) -> list[str]:
    """What a result says of it: nothing of a document that was accepted."""
    if look.refused:
        return [REFUSED.format(reason=look.refused)]
    return [] if look.checked else [UNCHECKED]


def withdrawn(proof: Proof) -> Proof:
    """A proof whose document was refused, as one that proves nothing."""
    nothing = tuple(replace(finding, least=0.0) for finding in proof.findings)
    return replace(proof, verdict=Verdict.UNKNOWN, least=0.0, findings=nothing)


def seconds_of(document: Mapping[str, Any]) -> float:
    """About how long the checker needs, s."""
    question, cases = document["question"], document["cases"]
    cells = sum(len(case["cells"]) for case in cases)
    if question["model"] != "earth":
        each = _CASE if question["model"] == "linear" else _BENT_CASE
        return each * len(cases) + _CELL * cells
    begins = [burn["time_s"] - question["burns"][0]["time_s"] for burn in question["burns"]]
    spans = [_longest(question, k) for k in range(len(begins))]
    near = {(max(case["burn"], 0), case.get("reference", case["kind"])) for case in cases}
    flown = max(b + span for b, span in zip(begins, spans, strict=True)) + sum(spans[k] for k, _ in near)
    orbits = flown * question["mean_motion_rad_s"] / math.tau
    return float(_ORBIT * orbits + _REFERENCE * len(near) + _EARTH_CASE * len(cases) + _EARTH_CELL * cells)


def _longest(question: Mapping[str, Any], burn: int) -> float:
    """How long the drifts of a burn are, s."""
    burns: Sequence[Mapping[str, Any]] = question["burns"]
    failures = question["failures"]
    own = (
        question["horizon_s"] + failures["late_s"] + failures["stuck_s"] + burns[burn].get("duration_s", 0.0)
    )
    if burn + 1 == len(burns):
        return float(own)
    return float(max(own, burns[burn + 1]["time_s"] - burns[burn]["time_s"] + failures["late_s"]))

"""Proof documents from exact answers; :mod:`safestart.certificates.proof` checks them, sharing no code."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np

from safestart.certificates.exact import Answer, Verdict
from safestart.certificates.question import Question
from safestart.certificates.statement import SCHEMA, digest_of
from safestart.errors import invalid
from safestart.scenario import Floats

# The claim stands back by what the solver's floats may have lost, in metres; for GO by more, so that the checker
# need not cut time into ever smaller pieces where a face is touched.
_NO_GO_STAND_BACK_M = 1e-9
_GO_STAND_BACK_M = 2e-7


def proof_of(question: Question, state: Floats, answer: Answer) -> dict[str, Any]:
    """JSON-able proof of a GO or NO_GO: the question, the start ``state`` (2 d,), the claim, witness or multipliers.

    The claim is the answer's margin less a stand-back (2e-7 m for GO, 1e-9 m for NO_GO). Raises ``InvalidInput`` for an
    UNDECIDED answer: there is nothing to prove.
    """
    d = question.dimensions
    target, shape = question.scenario.target, question.scenario.corridor
    document: dict[str, Any] = {
        "schema": SCHEMA,
        "verdict": answer.verdict.value,
        "question": {
            "kind": "stay",
            "dimensions": d,
            "dt_s": float(question.dt),
            "steps": question.steps,
            "tumble_rate_rad_s": float(target.tumble_rate),
            "mean_motion_rad_s": float(target.mean_motion),
            "max_acceleration_m_s2": float(question.scenario.chaser.max_acceleration),
            "corridor": {
                "c_x": float(shape.c_x),
                "c_z": float(shape.c_z),
                "x0_m": float(shape.x0),
                "z0_m": float(shape.z0),
                "hold_radius_m": float(shape.hold_radius),
            },
        },
        "start": {
            "frame": "lvlh",
            "position_m": np.asarray(state, dtype=np.float64)[:d].tolist(),
            "velocity_m_s": np.asarray(state, dtype=np.float64)[d:].tolist(),
        },
    }
    if answer.verdict is Verdict.GO and answer.thrust is not None:
        # A margin below the stand-back keeps a claim above 0 that the checker can still prove.
        document["margin_m"] = max(answer.lower - _GO_STAND_BACK_M, 0.5 * answer.lower)
        document["thrust_m_s2"] = answer.thrust.tolist()
    elif answer.verdict is Verdict.NO_GO:
        document["margin_m"] = min(answer.upper + _NO_GO_STAND_BACK_M, 0.5 * answer.upper)
        document["multipliers"] = [
            {"time_s": _within(row.time, question), "face": row.face, "value": row.value}
            for row in answer.multipliers
        ]
    else:
        raise invalid("answer", "a GO or NO_GO", answer.verdict.value)
    document["digest"] = digest_of(document)
    return document


def _within(time: float, question: Question) -> float:
    """The time, moved by an ulp where rounding put it beyond the exact horizon."""
    while Fraction(time) > Fraction(question.dt) * question.steps:
        time = math.nextafter(time, 0.0)
    return time

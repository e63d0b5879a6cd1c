"""Proof documents for families; :mod:`safestart.proofs.family` checks them, sharing no code."""

from __future__ import annotations

from typing import Any

import numpy as np

from safestart.errors import invalid
from safestart.exact.answer import Verdict
from safestart.exact.prove import GO_STAND_BACK_M, NO_GO_STAND_BACK_M, multiplier_of, question_of
from safestart.families.answer import ForAll
from safestart.families.members import Family
from safestart.model.scenario import Floats
from safestart.proofs.family_statement import SCHEMA
from safestart.proofs.statement import digest_of


def proof_for_all(family: Family, state: Floats, answer: ForAll) -> dict[str, Any]:
    """JSON-able proof of a GO or NO_GO for all members: intervals, start box, claim, histories or multipliers.

    The claim stands back from the margin as that of a single start does. Raises ``InvalidInput`` for
    an UNDECIDED answer.
    """
    d, question = family.question.dimensions, family.question
    state, half = np.asarray(state, dtype=np.float64), family.half
    document: dict[str, Any] = {
        "schema": SCHEMA,
        "verdict": answer.verdict.value,
        "question": question_of(question)
        | {
            "tumble_rate_rad_s": list(family.rates),
            "mean_motion_rad_s": list(family.motions),
            "max_acceleration_m_s2": list(family.thrusts),
        },
        "start": {
            "frame": "lvlh",
            "position_m": state[:d].tolist(),
            "velocity_m_s": state[d:].tolist(),
            "position_half_width_m": half[:d].tolist(),
            "velocity_half_width_m_s": half[d:].tolist(),
        },
    }
    if answer.verdict is Verdict.GO:
        document["margin_m"] = max(answer.margin_m - GO_STAND_BACK_M, 0.5 * answer.margin_m)
        document["witness"] = answer.witness
        document["tumble_rates_rad_s"] = list(answer.rates)
        document["mean_motions_rad_s"] = list(answer.motions)
        document["histories"] = [
            {"corner": list(history.corner), "thrust_m_s2": history.thrust.tolist()}
            for history in answer.histories
        ]
    elif answer.verdict is Verdict.NO_GO:
        document["margin_m"] = min(answer.margin_m + NO_GO_STAND_BACK_M, 0.5 * answer.margin_m)
        document["pieces"] = [
            {
                "tumble_rate_rad_s": list(piece.rates),
                "multipliers": [multiplier_of(row, question.latest) for row in piece.multipliers],
            }
            for piece in answer.pieces
        ]
    else:
        raise invalid("answer", "a GO or NO_GO", answer.verdict.value)
    document["digest"] = digest_of(document)
    return document

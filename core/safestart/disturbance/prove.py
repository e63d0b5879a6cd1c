"""Proof documents against a disturbance; :mod:`safestart.proofs.disturbed` checks them, sharing no code."""

from __future__ import annotations

from typing import Any

import numpy as np

from safestart.disturbance.tube import Disturbance, Tube
from safestart.errors import invalid
from safestart.exact.answer import Answer, Verdict
from safestart.exact.prove import proof_of, question_of
from safestart.exact.question import Question
from safestart.model.scenario import Floats
from safestart.proofs.disturbed_statement import SCHEMA
from safestart.proofs.statement import digest_of


def proof_against(
    question: Question, disturbance: Disturbance, tube: Tube, state: Floats, answer: Answer
) -> dict[str, Any]:
    """JSON-able proof of a GO that withstands ``disturbance``: bounds, feedback, tube and plan.

    ``question`` is the real one, ``tube`` the result of :func:`~safestart.disturbance.tube.tube_of` for it, ``answer``
    that of the tightened question for the start ``state`` (2 d,). A NO_GO needs no disturbance; it has a plain proof.
    Raises ``InvalidInput`` for an UNDECIDED answer.
    """
    if answer.verdict is not Verdict.GO:
        return proof_of(question, state, answer)
    if tube.question is None:
        raise invalid("tube", "one that leaves a question", tube.reason)
    document = proof_of(tube.question, np.asarray(state, dtype=np.float64), answer)
    space, gain = question.dimensions == 3, tube.gain
    plane = [0, 1, *(question.dimensions + axis for axis in (0, 1))]
    document |= {
        "schema": SCHEMA,
        "question": question_of(question),
        "disturbance": {
            "acceleration_m_s2": float(disturbance.acceleration),
            "position_m": float(disturbance.position),
            "velocity_m_s": float(disturbance.velocity),
        },
        "feedback": {"plane": gain[:2, plane].tolist()}
        | ({"cross": gain[2:, [2, 5]].tolist()} if space else {}),
        "tube": {"radius_m": tube.radius}
        | ({"height_m": tube.height} if space else {})
        | {"thrust_m_s2": tube.thrust},
    }
    document["digest"] = digest_of(document)
    return document

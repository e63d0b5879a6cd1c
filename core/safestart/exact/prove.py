"""Proof documents from exact answers; :mod:`safestart.proofs.single` checks them, sharing no code."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from safestart.errors import invalid
from safestart.exact.answer import Answer, Held, Multiplier, Verdict
from safestart.exact.limits import AT_END
from safestart.exact.question import SPEED_SCALE, Goal, Question
from safestart.model.scenario import Floats
from safestart.proofs.statement import SCHEMA, digest_of

# The claim is smaller than the margin by these stand-backs (m), which cover the solver's rounding; for GO by more, so
# that the checker need not cut time ever finer where the flight touches a face.
NO_GO_STAND_BACK_M = 1e-9
GO_STAND_BACK_M = 2e-7


def proof_of(question: Question, state: Floats, answer: Answer) -> dict[str, Any]:
    """JSON-able proof of a GO or NO_GO: the question, the start ``state`` (2 d,), the claim, witness or multipliers.

    The claim is the answer's margin less a stand-back (2e-7 m for GO, 1e-9 m for NO_GO). Raises ``InvalidInput`` for an
    UNDECIDED answer.
    """
    d = question.dimensions
    document: dict[str, Any] = {
        "schema": SCHEMA,
        "verdict": answer.verdict.value,
        "question": question_of(question),
        "start": {
            "frame": "lvlh",
            "position_m": np.asarray(state, dtype=np.float64)[:d].tolist(),
            "velocity_m_s": np.asarray(state, dtype=np.float64)[d:].tolist(),
        },
    }
    if answer.verdict is Verdict.GO and answer.thrust is not None:
        # A margin below the stand-back gets a smaller claim above 0 that the checker can still prove.
        document["margin_m"] = max(answer.lower - GO_STAND_BACK_M, 0.5 * answer.lower)
        document["thrust_m_s2"] = answer.thrust.tolist()
        if answer.arrival is not None:
            margin = answer.arrival.margin
            document["arrival"] = {
                "stop_s": answer.arrival.stop,
                "margin_m": max(margin - GO_STAND_BACK_M, 0.5 * margin),
            }
        if answer.held is not None:
            document["hold_after"] = _hold_after(answer.held)
    elif answer.verdict is Verdict.NO_GO:
        document["margin_m"] = min(answer.upper + NO_GO_STAND_BACK_M, 0.5 * answer.upper)
        document |= refuted_by(answer, question.latest, free=question.goal is not None)
    else:
        raise invalid("answer", "a GO or NO_GO", answer.verdict.value)
    document["digest"] = digest_of(document)
    return document


def _hold_after(held: Held) -> dict[str, Any]:
    return {
        "point_m": held.point.tolist(),
        "gain": held.gain.tolist(),
        "cost": held.cost.tolist(),
        "level": held.level,
        "margin_m": max(held.margin - GO_STAND_BACK_M, 0.5 * held.margin),
    }


def question_of(question: Question) -> dict[str, Any]:
    """The question in the document's form, in SI units."""
    target, shape = question.scenario.target, question.scenario.corridor
    return {
        "kind": question.kind,
        "dimensions": question.dimensions,
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
        **limits_of(question.goal, question.hold, question.speed_limit),
        **({"keep_out_m": float(question.keep_out)} if question.keep_out > 0.0 else {}),
    }


def limits_of(goal: Goal | None, hold: Sequence[float], speed_limit: float | None) -> dict[str, Any]:
    """The demands of a question at its end and on the speed, in the document's form."""
    out: dict[str, Any] = {}
    if goal is not None:
        out["earliest_step"] = goal.earliest
        out["goal"] = {
            "hold_m": [float(e) for e in hold],
            "radius_m": float(goal.radius),
            "rest_m_s": float(goal.rest),
        }
    if speed_limit is not None:
        out["speed_limit"] = {"most_m_s": float(speed_limit), "scale_s": SPEED_SCALE}
    return out


def refuted_by(answer: Answer, latest: float, *, free: bool) -> dict[str, Any]:
    """The evidence of a NO_GO: multipliers, or parts for the ends where the end is ``free``."""
    if not free:
        return {"multipliers": [multiplier_of(row, latest) for row in answer.multipliers]}
    return {
        "parts": [
            {
                "first_step": part.first,
                "last_step": part.last,
                "multipliers": [multiplier_of(row, latest) for row in part.multipliers],
            }
            for part in answer.parts
        ]
    }


def multiplier_of(row: Multiplier, latest: float) -> dict[str, Any]:
    """One multiplier in the document's form; ``latest`` is the question's, s."""
    time = {} if row.face in AT_END else {"time_s": min(row.time, latest)}
    return time | {"face": row.face, "value": row.value} | ({"pull": list(row.pull)} if row.pull else {})

"""The statement of a proof against a disturbance, read strictly: question, bounds, feedback, tube, plan.

Part of the checker. The question is the real one, with the whole corridor and all the thrust; the plan is a plain
statement (``statement.py``) about it, and the tube uses part of its margins.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from flint import fmpq

from safestart.proofs import statement
from safestart.proofs.statement import Stated
from safestart.proofs.strict import ProofRejected, fields, number, part, vector

SCHEMA = "safestart-proof-disturbed/1"
_LONGEST_INTERVAL_S = 60


@dataclass(frozen=True, slots=True)
class StatedDisturbed:
    """A document's statement in SI.

    ``push`` bounds the disturbance's acceleration, ``away`` and ``fast`` the distance in position and velocity between
    the start and the plan's beginning. ``plane`` (2, 4) and ``cross`` (1, 2, empty in the plane) are the feedback's
    gains on the errors of position and velocity. ``radius`` and ``height`` bound the error of position in the orbit
    plane and across it, ``thrust`` the feedback's thrust; ``plan`` has the real question, its claim and the plan's
    thrusts.
    """

    plan: Stated
    push: fmpq
    away: fmpq
    fast: fmpq
    plane: list[list[fmpq]]
    cross: list[list[fmpq]]
    radius: fmpq
    height: fmpq
    thrust: fmpq


def read(document: Any) -> StatedDisturbed:
    """The statement of a document; raise :class:`ProofRejected` when it is malformed."""
    statement.check_seal(document, SCHEMA)
    own = ("disturbance", "feedback", "tube")
    fields(document, "document", (*statement.DOCUMENT, *own, "thrust_m_s2"))
    question = document["question"]
    if document["verdict"] != "GO" or part(question, "kind", str) != "stay" or "speed_limit" in question:
        raise ProofRejected("verdict, kind: required GO to stay without a speed limit")
    plain = {key: value for key, value in document.items() if key not in own}
    plain["schema"] = statement.SCHEMA
    plan = statement.read(plain | {"digest": statement.digest_of(plain)})
    if plan.dt > _LONGEST_INTERVAL_S:
        raise ProofRejected(f"dt_s: required at most {_LONGEST_INTERVAL_S} s against a disturbance")
    space = plan.d == 3
    bounds, gains, tube = (document[key] for key in own)
    fields(bounds, "disturbance", ("acceleration_m_s2", "position_m", "velocity_m_s"))
    fields(gains, "feedback", ("plane", "cross") if space else ("plane",))
    fields(tube, "tube", ("radius_m", "height_m", "thrust_m_s2") if space else ("radius_m", "thrust_m_s2"))
    push, away, fast = (
        number(bounds, key, 0.0) for key in ("acceleration_m_s2", "position_m", "velocity_m_s")
    )
    return StatedDisturbed(
        plan=plan,
        push=push,
        away=away,
        fast=fast,
        plane=_gain(gains, "plane", 2),
        cross=_gain(gains, "cross", 1) if space else [],
        radius=number(tube, "radius_m", 0.0),
        height=number(tube, "height_m", 0.0) if space else fmpq(0),
        thrust=number(tube, "thrust_m_s2", 0.0),
    )


def _gain(gains: Mapping[str, Any], key: str, size: int) -> list[list[fmpq]]:
    rows = part(gains, key, list)
    if len(rows) != size:
        raise ProofRejected(f"feedback.{key}: required {size} rows, received {len(rows)}")
    return [vector(row, f"feedback.{key}", 2 * size) for row in rows]

"""What a document says of the time after the end of `synchronize`, read strictly: feedback, ellipsoid, margin."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from flint import fmpq

from safestart.proofs.strict import ProofRejected, exact, fields, number, part, shown, vector

FIELD = "hold_after"
_LARGEST = 1e12


@dataclass(frozen=True, slots=True)
class StatedHold:
    """The thrust is u_ref + ``gain`` (2, 4) (x - x_ref), held over the question's steps, x position and velocity in
    LVLH in the orbit plane.

    x_ref is at ``point`` (2,), m, of the body frame at every step. Every x with (x - x_ref)' ``cost`` (x - x_ref) <=
    ``level`` at a step stays for ever, at least ``margin`` m from every face; the flight ends at such an x.
    """

    point: list[fmpq]
    gain: list[list[fmpq]]
    cost: list[list[fmpq]]
    level: fmpq
    margin: fmpq


def read(claim: Any, d: int) -> StatedHold:
    """The claim of a question in ``d`` dimensions; raise :class:`ProofRejected` when it is malformed."""
    fields(claim, FIELD, ("point_m", "gain", "cost", "level", "margin_m"))
    if d != 2:
        raise ProofRejected(f"{FIELD}: required a question in the orbit plane")
    cost = _rows(claim, "cost", 4)
    if any(cost[i][j] != cost[j][i] for i in range(4) for j in range(i)):
        raise ProofRejected(f"{FIELD}.cost: required a symmetric matrix")
    return StatedHold(
        point=vector(claim["point_m"], f"{FIELD}.point_m", 2),
        gain=_rows(claim, "gain", 2),
        cost=cost,
        level=_positive(claim, "level"),
        margin=_positive(claim, "margin_m"),
    )


def _positive(claim: Mapping[str, Any], key: str) -> fmpq:
    value = number(claim, key, 0.0, _LARGEST)
    if not value > 0:
        raise ProofRejected(f"{FIELD}.{key}: required > 0, received {shown(claim[key])}")
    return value


def _rows(claim: Mapping[str, Any], key: str, count: int) -> list[list[fmpq]]:
    """``count`` rows of 4 numbers."""
    name, rows = f"{FIELD}.{key}", part(claim, key, list)
    if len(rows) != count or not all(isinstance(row, list) and len(row) == 4 for row in rows):
        raise ProofRejected(f"{name}: required {count} rows of 4 numbers, received {shown(rows)}")
    return [[exact(entry, name, -_LARGEST, _LARGEST) for entry in row] for row in rows]

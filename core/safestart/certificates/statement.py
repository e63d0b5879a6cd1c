"""What a proof document states, read strictly: every number the double it is, as an exact rational.

Part of the checker (:mod:`safestart.certificates.proof`): it shares no code with what makes the proofs.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from flint import fmpq

from safestart.errors import SafestartError

SCHEMA = "safestart-proof/1"
_MOST_STEPS, _MOST_MULTIPLIERS, _LARGEST = 400, 20_000, 1e7
# Face: the signs of its normal, whose y (and only y) is scaled by the slope; y >= r_h, then +x, -x, +z, -z sides.
_FACES = {
    "hold_plane": (0, -1, 0),
    "right": (1, -1, 0),
    "left": (-1, -1, 0),
    "top": (0, -1, 1),
    "bottom": (0, -1, -1),
}


class ProofRejected(SafestartError):
    """The document proves nothing; the message names the inequality that fails, with its numbers."""

    status = 422
    slug = "proof-rejected"
    title = "Proof rejected"


@dataclass(frozen=True, slots=True)
class Stated:
    """A document's statement in SI: question, start (2 d numbers), claim and the evidence for it.

    ``faces`` maps a name to (normal, offset); ``thrust`` (N, d) for GO, ``weights`` (time, face, value) for NO_GO.
    """

    verdict: str
    d: int
    steps: int
    dt: fmpq
    n: fmpq
    w: fmpq
    a_max: fmpq
    faces: dict[str, tuple[list[fmpq], fmpq]]
    start: list[fmpq]
    claim: fmpq
    thrust: list[list[fmpq]]
    weights: list[tuple[fmpq, str, fmpq]]


def digest_of(document: Mapping[str, Any]) -> str:
    """SHA-256 of the document without its ``digest``, as JSON with sorted keys and no spaces."""
    rest = {key: value for key, value in document.items() if key != "digest"}
    text = json.dumps(rest, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def read(document: Any) -> Stated:
    """The statement of a document; raise :class:`ProofRejected` when it is malformed or its digest is another's."""
    if not isinstance(document, Mapping) or document.get("schema") != SCHEMA:
        raise ProofRejected(f"schema: required a document of schema {SCHEMA}")
    try:
        digest = digest_of(document)
    except (TypeError, ValueError, RecursionError) as error:
        raise ProofRejected(f"document: required plain JSON ({error})") from None
    if document.get("digest") != digest:
        raise ProofRejected(f"digest: required {digest}, received {str(document.get('digest'))[:80]}")
    question, start = _part(document, "question", dict), _part(document, "start", dict)
    verdict = document.get("verdict")
    if question.get("kind") != "stay" or verdict not in ("GO", "NO_GO"):
        raise ProofRejected("kind, verdict: required stay and GO or NO_GO")
    d, steps = _part(question, "dimensions", int), _part(question, "steps", int)
    if d not in (2, 3) or not 1 <= steps <= _MOST_STEPS:
        raise ProofRejected(f"dimensions, steps: required 2 or 3 and 1..{_MOST_STEPS}")
    dt = _number(question, "dt_s", 1e-6, 3600.0)
    faces = _faces(_part(question, "corridor", dict), d)
    go = verdict == "GO"
    return Stated(
        verdict=verdict,
        d=d,
        steps=steps,
        dt=dt,
        n=_number(question, "mean_motion_rad_s", 0.0, 0.01),
        w=_number(question, "tumble_rate_rad_s", 0.0, 10.0),
        a_max=_number(question, "max_acceleration_m_s2", 0.0, 1e3),
        faces=faces,
        start=_vector(start.get("position_m"), "position_m", d)
        + _vector(start.get("velocity_m_s"), "velocity_m_s", d),
        claim=_number(document, "margin_m", -_LARGEST),
        thrust=_thrust(_part(document, "thrust_m_s2", list), steps, d) if go else [],
        weights=[] if go else _weights(_part(document, "multipliers", list), faces, dt * steps),
    )


def _part(document: Any, key: str, kind: type) -> Any:
    value = document.get(key) if isinstance(document, Mapping) else None
    if not isinstance(value, kind) or isinstance(value, bool):
        raise ProofRejected(f"{key}: required a {kind.__name__}, received {type(value).__name__}")
    return value


def _exact(value: Any, name: str, low: float, high: float = _LARGEST) -> fmpq:
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise ProofRejected(f"{name}: required a number in [{low:g}, {high:g}], received {str(value)[:60]}")
    return fmpq(*value.as_integer_ratio())


def _number(document: Any, key: str, low: float, high: float = _LARGEST) -> fmpq:
    if not isinstance(document, Mapping):
        raise ProofRejected(f"{key}: required an object that holds it, received {str(document)[:60]}")
    return _exact(document.get(key), key, low, high)


def _vector(value: Any, name: str, size: int) -> list[fmpq]:
    if not isinstance(value, list) or len(value) != size:
        raise ProofRejected(f"{name}: required a list of {size} numbers, received {str(value)[:60]}")
    return [_exact(entry, name, -_LARGEST) for entry in value]


def _faces(shape: Any, d: int) -> dict[str, tuple[list[fmpq], fmpq]]:
    hold = _number(shape, "hold_radius_m", 0.0)
    sides = {axis: (_number(shape, f"c_{axis}", 0.0), _number(shape, f"{axis}0_m", 0.0)) for axis in "xz"}
    out = {}
    for name, (x, y, z) in list(_FACES.items())[: 3 if d == 2 else 5]:
        slope, width = sides["x"] if x else sides["z"] if z else (fmpq(1), fmpq(0))
        out[name] = [fmpq(x), y * slope, fmpq(z)][:d], width - slope * hold
    return out


def _thrust(history: list[Any], steps: int, d: int) -> list[list[fmpq]]:
    if len(history) != steps:
        raise ProofRejected(f"thrust_m_s2: required {steps} thrusts, received {len(history)}")
    return [_vector(entry, "thrust_m_s2", d) for entry in history]


def _weights(rows: list[Any], faces: Mapping[str, Any], horizon: fmpq) -> list[tuple[fmpq, str, fmpq]]:
    if not 1 <= len(rows) <= _MOST_MULTIPLIERS:
        raise ProofRejected(f"multipliers: required 1..{_MOST_MULTIPLIERS}, received {len(rows)}")
    out = []
    for row in rows:
        time, value = _number(row, "time_s", 0.0), _number(row, "value", 0.0)
        face = row.get("face")
        if time > horizon or not isinstance(face, str) or face not in faces:
            raise ProofRejected(
                f"multipliers: required a face and a time in [0, T], received {str(row)[:90]}"
            )
        out.append((time, face, value))
    return out

"""The statement of a proof document, read strictly: every number is a double, taken as an exact rational.

Part of the checker (:mod:`safestart.proofs.single`), which shares no code with the provers.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from flint import fmpq

from safestart.proofs.hold import statement as hold
from safestart.proofs.hold.statement import StatedHold
from safestart.proofs.strict import LARGEST, ProofRejected, fields, number, part, shown, vector
from safestart.proofs.weights import Limits, Weight, limits_of, parts_of

SCHEMA = "safestart-proof/1"
DOCUMENT = ("schema", "digest", "verdict", "margin_m", "question", "start")
"""Fields of every kind of document."""
_MOST_STEPS = 400
_QUESTION = (
    *("kind", "dimensions", "dt_s", "steps", "corridor"),
    *("tumble_rate_rad_s", "mean_motion_rad_s", "max_acceleration_m_s2"),
)
_SHAPE = ("c_x", "c_z", "x0_m", "z0_m", "hold_radius_m")
_START = ("frame", "position_m", "velocity_m_s")
# Face: the signs of its normal, whose y (and only y) is scaled by the slope; y >= r_h, then +x, -x, +z, -z sides.
_FACES = {
    "hold_plane": (0, -1, 0),
    "right": (1, -1, 0),
    "left": (-1, -1, 0),
    "top": (0, -1, 1),
    "bottom": (0, -1, -1),
}


@dataclass(frozen=True, slots=True)
class Stated:
    """A document's statement in SI: question, start (2 d numbers), claim and the evidence for it.

    ``shape`` holds the corridor's numbers, ``faces`` maps a name to (normal, offset). The end is any of the steps
    ``earliest`` .. ``steps``; both are equal if it is fixed. ``thrust`` (k, d) for GO; for NO_GO ``parts`` (first,
    last, weights), each against the ends first .. last, together against all ends in question. ``arrival`` (stop in
    s, margin in m) and ``held`` claim that a `synchronize` GO goes on for ever, by a stop and by a feedback.
    """

    verdict: str
    d: int
    earliest: int
    steps: int
    dt: fmpq
    n: fmpq
    w: fmpq
    a_max: fmpq
    shape: dict[str, fmpq]
    faces: dict[str, tuple[list[fmpq], fmpq]]
    limits: Limits
    start: list[fmpq]
    claim: fmpq
    thrust: list[list[fmpq]]
    parts: list[tuple[int, int, list[Weight]]]
    arrival: tuple[fmpq, fmpq] | None = None
    held: StatedHold | None = None


def digest_of(document: Mapping[str, Any]) -> str:
    """SHA-256 of the document without its ``digest``, as JSON with sorted keys and no spaces."""
    rest = {key: value for key, value in document.items() if key != "digest"}
    text = json.dumps(rest, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def check_seal(document: Any, schema: str) -> None:
    """Raise :class:`ProofRejected` unless the document is an object of that schema and its digest is right."""
    if not isinstance(document, Mapping) or document.get("schema") != schema:
        raise ProofRejected(f"schema: required a document of schema {schema}")
    try:
        digest = digest_of(document)
    except (TypeError, ValueError, RecursionError) as error:
        raise ProofRejected(f"document: required plain JSON ({error})") from None
    if document.get("digest") != digest:
        raise ProofRejected(f"digest: required {digest}, received {shown(document.get('digest'), 80)}")


def read(document: Any) -> Stated:
    """The statement of a document; raise :class:`ProofRejected` when it is malformed or its digest is wrong."""
    check_seal(document, SCHEMA)
    verdict, question, start = document.get("verdict"), document.get("question"), document.get("start")
    kind = part(question, "kind", str)
    if kind not in ("stay", "synchronize") or verdict not in ("GO", "NO_GO"):
        raise ProofRejected("kind, verdict: required stay or synchronize, and GO or NO_GO")
    go, free = verdict == "GO", kind == "synchronize"
    proved_by = "thrust_m_s2" if go else "parts" if free else "multipliers"
    fields(document, "document", (*DOCUMENT, proved_by), ("arrival", hold.FIELD) if go and free else ())
    ends = ("earliest_step", "goal") if free else ()
    fields(question, f"question ({kind})", (*_QUESTION, *ends), ("speed_limit", "keep_out_m"))
    d, steps = part(question, "dimensions", int), part(question, "steps", int)
    if d not in (2, 3) or not 1 <= steps <= _MOST_STEPS:
        raise ProofRejected(f"dimensions, steps: required 2 or 3 and 1..{_MOST_STEPS}")
    dt = number(question, "dt_s", 1e-6, 3600.0)
    shape = _shape(question["corridor"])
    faces = _faces(shape, d)
    earliest = part(question, "earliest_step", int) if free else steps
    if not 1 <= earliest <= steps:
        raise ProofRejected(f"earliest_step: required 1..{steps}, received {earliest}")
    limits = limits_of(question, d, free)
    evidence = part(document, proved_by, list)
    parts = evidence if free else [{"first_step": steps, "last_step": steps, "multipliers": evidence}]
    return Stated(
        verdict=verdict,
        d=d,
        earliest=earliest,
        steps=steps,
        dt=dt,
        n=number(question, "mean_motion_rad_s", 0.0, 0.01),
        w=number(question, "tumble_rate_rad_s", 0.0, 10.0),
        a_max=number(question, "max_acceleration_m_s2", 0.0, 1e3),
        shape=shape,
        faces=faces,
        limits=limits,
        start=_start(start, d),
        claim=_claim(document, go),
        thrust=_thrust(evidence, earliest, steps, d) if go else [],
        parts=[] if go else parts_of(parts, (earliest, steps), faces, limits, dt * steps, d),
        arrival=_arrival(document["arrival"]) if "arrival" in document else None,
        held=hold.read(document[hold.FIELD], d) if hold.FIELD in document else None,
    )


def _arrival(claim: Any) -> tuple[fmpq, fmpq]:
    """Seconds to stop and the least distance to a face afterwards, both above 0."""
    fields(claim, "arrival", ("stop_s", "margin_m"))
    stop, margin = number(claim, "stop_s", 1e-6, 1e6), number(claim, "margin_m", 0.0)
    if not margin > 0:
        raise ProofRejected(f"arrival.margin_m: required > 0, received {shown(claim['margin_m'])}")
    return stop, margin


def _claim(document: Any, go: bool) -> fmpq:
    """The margin claimed: above 0 for GO, below 0 for NO_GO."""
    claim = number(document, "margin_m", -LARGEST)
    if not (claim > 0 if go else claim < 0):
        sign = "> 0 for GO" if go else "< 0 for NO_GO"
        raise ProofRejected(f"margin_m: required {sign}, received {shown(document['margin_m'])}")
    return claim


def _start(start: Any, d: int) -> list[fmpq]:
    fields(start, "start", _START)
    if start["frame"] != "lvlh":
        raise ProofRejected(f"frame: required lvlh, received {shown(start['frame'])}")
    return vector(start["position_m"], "position_m", d) + vector(start["velocity_m_s"], "velocity_m_s", d)


def _shape(corridor: Any) -> dict[str, fmpq]:
    fields(corridor, "corridor", _SHAPE)
    return {key: number(corridor, key, 0.0) for key in _SHAPE}


def _faces(shape: Mapping[str, fmpq], d: int) -> dict[str, tuple[list[fmpq], fmpq]]:
    hold = shape["hold_radius_m"]
    sides = {axis: (shape[f"c_{axis}"], shape[f"{axis}0_m"]) for axis in "xz"}
    out = {}
    for name, (x, y, z) in list(_FACES.items())[: 3 if d == 2 else 5]:
        slope, width = sides["x"] if x else sides["z"] if z else (fmpq(1), fmpq(0))
        out[name] = [fmpq(x), y * slope, fmpq(z)][:d], width - slope * hold
    return out


def _thrust(history: list[Any], earliest: int, steps: int, d: int) -> list[list[fmpq]]:
    if not earliest <= len(history) <= steps:
        raise ProofRejected(f"thrust_m_s2: required {earliest} to {steps} thrusts, received {len(history)}")
    return [vector(entry, "thrust_m_s2", d) for entry in history]

"""What a proof document in space states, read strictly: every number the double it is, as an exact rational."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from flint import fmpq

from safestart.proofs.space.demands import KEYS, Demands, View, demands_of
from safestart.proofs.space.parts import Attitude, Face, Thrust, attitude_of, faces_of, thrust_of
from safestart.proofs.space.unknowns import Unknowns, unknowns_of
from safestart.proofs.statement import DOCUMENT, check_seal
from safestart.proofs.strict import LARGEST, ProofRejected, fields, number, part, shown, vector
from safestart.proofs.weights import Limits, Weight, limits_of, parts_of

SCHEMA = "safestart-proof/2"
_MOST_STEPS = 400
_QUESTION = ("kind", "dt_s", "steps", "orbit", "attitude", "faces", "thrust")
_BOX = ("position_half_width_m", "velocity_half_width_m_s")


@dataclass(frozen=True, slots=True)
class SpaceStated:
    """A document's statement: question, start (6 numbers), claim (m), and the evidence.

    ``half`` (6) are the half-widths of the box of starts, 0 where the start is known; ``unknowns`` what else is not
    known, None where all is. The end is any of the steps
    ``earliest`` .. ``steps``; both are equal if it is fixed. ``history`` (k, channels) for GO: m/s^2 for a ball, else
    shares of the bounds. For NO_GO ``parts`` (first, last, weights), each against the ends first .. last, together
    against all ends in question.
    """

    verdict: str
    dt: fmpq
    earliest: int
    steps: int
    mean_motion: fmpq
    eccentricity: fmpq
    true_anomaly: fmpq
    attitude: Attitude
    faces: dict[str, Face]
    thrust: Thrust
    limits: Limits
    demands: Demands
    unknowns: Unknowns | None
    start: list[fmpq]
    half: list[fmpq]
    claim: fmpq
    history: list[list[fmpq]]
    parts: list[tuple[int, int, list[Weight]]]
    violated: str


def read(document: Any) -> SpaceStated:
    """The statement of a document; raise :class:`ProofRejected` when it is malformed or its digest is another's."""
    check_seal(document, SCHEMA)
    verdict = document.get("verdict")
    if verdict not in ("GO", "NO_GO"):
        raise ProofRejected(f"verdict: required GO or NO_GO, received {shown(verdict)}")
    question = document.get("question")
    kind = part(question, "kind", str)
    if kind not in ("stay", "synchronize"):
        raise ProofRejected(f"kind: required stay or synchronize, received {shown(kind)}")
    free, thrust = kind == "synchronize", thrust_of(part(question, "thrust", dict))
    proved_by = "parts" if free else "multipliers"
    if verdict == "GO":
        proved_by = "thrust_m_s2" if thrust.kind == "ball" else "throttle"
    elif "violated" in document:
        proved_by = "violated"
    fields(document, "document", (*DOCUMENT, proved_by))
    ends = ("earliest_step", "goal") if free else ()
    fields(question, f"question ({kind})", (*_QUESTION, *ends), ("speed_limit", "unknowns", *KEYS))
    steps, dt = part(question, "steps", int), number(question, "dt_s", 1e-6, 3600.0)
    if not 1 <= steps <= _MOST_STEPS:
        raise ProofRejected(f"steps: required 1..{_MOST_STEPS}, received {steps}")
    orbit = part(question, "orbit", dict)
    fields(orbit, "orbit", ("mean_motion_rad_s", "eccentricity", "true_anomaly_rad"))
    earliest = part(question, "earliest_step", int) if free else steps
    if not 1 <= earliest <= steps:
        raise ProofRejected(f"earliest_step: required 1..{steps}, received {earliest}")
    faces, limits = faces_of(part(question, "faces", list)), limits_of(question, 3, free)
    if any(name in faces for name in limits.norms):
        raise ProofRejected(f"faces: required names other than {', '.join(limits.norms)}")
    demands = demands_of(question, {*faces, *limits.norms})
    cones = [name for name, region in demands.regions.items() if isinstance(region, View)]
    if any(name in faces for name in cones):
        raise ProofRejected(f"faces: required names other than {', '.join(cones)}")
    if demands.plume is not None and thrust.kind != "ball":
        raise ProofRejected(f"plume: required thrust of kind ball, received {shown(thrust.kind)}")
    start = document["start"]
    known = not (isinstance(start, dict) and _BOX[0] in start)
    fields(start, "start", ("frame", "position_m", "velocity_m_s", *(() if known else _BOX)))
    if start["frame"] != "lvlh":
        raise ProofRejected(f"start: required the frame lvlh, received {shown(start['frame'])}")
    claim = number(document, "margin_m", -LARGEST)
    if not (claim > 0 if verdict == "GO" else claim < 0):
        raise ProofRejected(
            f"margin_m: required > 0 for GO and < 0 for NO_GO, received {shown(document['margin_m'])}"
        )
    half = [fmpq(0)] * 6
    if not known:
        half = [e for key in _BOX for e in vector(start[key], key, 3)]
        if any(e < 0 for e in half) or free or limits.most is not None or demands:
            raise ProofRejected(
                f"{_BOX[0]}: required half-widths >= 0, and stay without a speed limit or demands"
            )
    attitude = attitude_of(part(question, "attitude", dict), dt * steps)
    unknowns = unknowns_of(question["unknowns"], attitude) if "unknowns" in question else None
    if unknowns is not None:
        if free or limits.most is not None or demands:
            raise ProofRejected("unknowns: required stay without a speed limit or demands")
        if unknowns.turns and thrust.frame == "body":
            raise ProofRejected("unknowns: required thrusts in axes of LVLH where the attitude is not known")
    violated = str(part(document, "violated", str)) if proved_by == "violated" else ""
    evidence = [] if violated else part(document, proved_by, list)
    rows = evidence if free else [{"first_step": steps, "last_step": steps, "multipliers": evidence}]
    return SpaceStated(
        verdict=verdict,
        dt=dt,
        earliest=earliest,
        steps=steps,
        mean_motion=number(orbit, "mean_motion_rad_s", 0.0, 0.01),
        eccentricity=number(orbit, "eccentricity", 0.0, 0.9),
        true_anomaly=number(orbit, "true_anomaly_rad", -1e4, 1e4),
        attitude=attitude,
        faces=faces,
        thrust=thrust,
        limits=limits,
        demands=demands,
        unknowns=unknowns,
        start=vector(start["position_m"], "position_m", 3) + vector(start["velocity_m_s"], "velocity_m_s", 3),
        half=half,
        claim=claim,
        history=_history(evidence, earliest, steps, thrust) if verdict == "GO" else [],
        parts=[]
        if verdict == "GO" or violated
        else parts_of(rows, (earliest, steps), faces, limits, dt * steps, 3, cones),
        violated=violated,
    )


def _history(rows: list[Any], earliest: int, steps: int, thrust: Thrust) -> list[list[fmpq]]:
    if not earliest <= len(rows) <= steps:
        raise ProofRejected(f"thrusts: required {earliest} to {steps}, received {len(rows)}")
    return [vector(row, "thrust", thrust.channels) for row in rows]

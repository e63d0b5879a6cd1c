"""The statement of a proof for a family, read strictly and split into statements about single members.

Part of the checker. A GO document holds at its nodes, one plain statement (``statement.py``) per history, tumble rate
and mean motion; a NO_GO document holds on its pieces, one plain statement per piece, read at the piece's lower ends.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from flint import fmpq

from safestart.proofs import statement
from safestart.proofs.statement import Stated
from safestart.proofs.strict import ProofRejected, exact, fields, part, shown, vector

SCHEMA = "safestart-proof-for-all/1"
_HALF = ("position_half_width_m", "velocity_half_width_m_s")
_GO = ("witness", "tumble_rates_rad_s", "mean_motions_rad_s", "histories")
_MOST, _MOST_CASES = 4096, 8192
Rationals = list[fmpq]


@dataclass(frozen=True, slots=True)
class StatedForAll:
    """A document's statement: intervals (low, high) as exact rationals, the box's half-widths, and its cases.

    ``middle`` is the question about the middle of the start box, with the ends of the intervals that bind; ``box`` the
    half-widths around it. GO: ``rates`` and ``motions`` are the nodes, ``cases`` the statements at each of them,
    ``half`` the half-widths that each history must cover. NO_GO: ``cases`` go with ``pieces``, intervals of the tumble
    rate, and ``half`` is the box.
    """

    verdict: str
    witness: str
    middle: Stated
    thrusts: Rationals
    box: Rationals
    rates: Rationals
    motions: Rationals
    half: Rationals
    cases: list[Stated]
    pieces: list[Rationals]


def read(document: Any) -> StatedForAll:
    """The statement of a document; raise :class:`ProofRejected` when it is malformed."""
    statement.check_seal(document, SCHEMA)
    verdict, question, start = document.get("verdict"), document.get("question"), document.get("start")
    go = verdict == "GO"
    fields(document, "document", (*statement.DOCUMENT, *(_GO if go else ("pieces",))))
    if part(question, "kind", str) != "stay" or "speed_limit" in question:
        raise ProofRejected("kind: required stay without a speed limit")
    rates, motions, thrusts = (
        _ascending(question, key, 2, 2)
        for key in ("tumble_rate_rad_s", "mean_motion_rad_s", "max_acceleration_m_s2")
    )
    d = part(question, "dimensions", int)
    half = [e for key in _HALF for e in _half_widths(start, key, d)]
    plain = {
        "schema": statement.SCHEMA,
        "verdict": verdict,
        "margin_m": document["margin_m"],
        "question": question
        | {
            "tumble_rate_rad_s": rates[1],
            "mean_motion_rad_s": motions[1],
            # The smaller disk lies in the larger: GO needs the least thrust, NO_GO the most.
            "max_acceleration_m_s2": thrusts[0 if go else 1],
        },
        "start": {key: value for key, value in start.items() if key not in _HALF},
    }
    cases, pieces = _go(document, plain, half, rates, motions) if go else _no_go(document, plain, rates)
    ends = [[exact(e, "interval", 0.0) for e in pair] for pair in (rates, motions, thrusts)]
    nodes = (
        [[exact(e, key, 0.0) for e in document[key]] for key in ("tumble_rates_rad_s", "mean_motions_rad_s")]
        if go
        else ends[:2]
    )
    common = not go or document["witness"] == "common"
    return StatedForAll(
        verdict=str(verdict),
        witness=document["witness"] if go else "",
        middle=replace(cases[0], start=_middle(start, d)),
        thrusts=ends[2],
        box=half,
        rates=nodes[0],
        motions=nodes[1],
        # The history of a corner starts exactly there.
        half=half if common else [fmpq(0)] * len(half),
        cases=cases,
        pieces=pieces,
    )


def _middle(start: Mapping[str, Any], d: int) -> Rationals:
    return vector(start["position_m"], "position_m", d) + vector(start["velocity_m_s"], "velocity_m_s", d)


def _go(
    document: Mapping[str, Any],
    plain: dict[str, Any],
    half: Rationals,
    rates: list[float],
    motions: list[float],
) -> tuple[list[Stated], list[Rationals]]:
    at = [
        _nodes(document, "tumble_rates_rad_s", rates),
        _nodes(document, "mean_motions_rad_s", motions),
    ]
    witness, histories = document["witness"], part(document, "histories", list)
    if witness not in ("common", "per_corner"):
        raise ProofRejected(f"witness: required common or per_corner, received {shown(witness)}")
    wide = [i for i, width in enumerate(half) if width > 0]
    required = [[0] * len(half)]
    if witness == "per_corner":
        required = []
        for ends in itertools.product((1, -1), repeat=len(wide)):
            sign = dict(zip(wide, ends, strict=True))
            required.append([sign.get(i, 0) for i in range(len(half))])
    for history in histories:
        fields(history, "histories", ("corner", "thrust_m_s2"))
    corners = [part(history, "corner", list) for history in histories]
    if sorted(map(str, corners)) != sorted(map(str, required)):
        raise ProofRejected(
            f"histories: required one for each of {len(required)} corners, received {len(corners)}"
        )
    if len(histories) * len(at[0]) * len(at[1]) > _MOST_CASES:
        raise ProofRejected(f"histories, nodes: required at most {_MOST_CASES} pairs of them")
    cases = []
    for history, corner in zip(histories, corners, strict=True):
        stated = _plain(plain | {"thrust_m_s2": history["thrust_m_s2"]})
        moved = [e + int(sign) * width for e, sign, width in zip(stated.start, corner, half, strict=True)]
        cases += [replace(stated, start=moved, w=w, n=n) for w, n in itertools.product(*at)]
    return cases, []


def _no_go(
    document: Mapping[str, Any], plain: dict[str, Any], rates: list[float]
) -> tuple[list[Stated], list[Rationals]]:
    cases, pieces, reached = [], [], rates[0]
    entries = part(document, "pieces", list)
    for entry in entries[:_MOST]:
        fields(entry, "pieces", ("tumble_rate_rad_s", "multipliers"))
        ends = _ascending(entry, "tumble_rate_rad_s", 2, 2)
        if ends[0] != reached:
            raise ProofRejected(
                f"pieces: required one from tumble rate {reached!r} rad/s on, received {ends[0]!r}"
            )
        reached = ends[1]
        pieces.append([exact(e, "tumble_rate_rad_s", 0.0) for e in ends])
        cases.append(_plain(plain | {"multipliers": entry["multipliers"]}))
    if not entries or len(entries) > _MOST or reached != rates[1]:
        raise ProofRejected(
            f"pieces: required them up to tumble rate {rates[1]!r} rad/s, received up to {reached!r}"
        )
    return cases, pieces


def _plain(document: dict[str, Any]) -> Stated:
    return statement.read(document | {"digest": statement.digest_of(document)})


def _nodes(document: Mapping[str, Any], key: str, ends: list[float]) -> Rationals:
    values = _ascending(document, key, 1, _MOST)
    if (values[0], values[-1]) != (ends[0], ends[1]):
        received = f"{values[0]!r} to {values[-1]!r}"
        raise ProofRejected(f"{key}: required from {ends[0]!r} to {ends[1]!r}, received {received}")
    return [exact(e, key, 0.0) for e in values]


def _ascending(document: Any, key: str, least: int, most: int) -> list[float]:
    """Numbers >= 0 in ascending order."""
    values: list[float] = part(document, key, list)
    if not least <= len(values) <= most:
        raise ProofRejected(f"{key}: required {least} to {most} numbers, received {len(values)}")
    if any(b < a for a, b in itertools.pairwise([exact(e, key, 0.0) for e in values])):
        raise ProofRejected(f"{key}: required ascending numbers, received {shown(values)}")
    return values


def _half_widths(start: Any, key: str, d: int) -> Rationals:
    if not isinstance(start, Mapping):
        raise ProofRejected(f"start: required an object, received {type(start).__name__}")
    out = vector(start.get(key), key, d)
    if any(e < 0 for e in out):
        raise ProofRejected(f"{key}: required numbers >= 0")
    return out

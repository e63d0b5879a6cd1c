"""What a proof for a family states, read strictly: it comes apart into statements about single members.

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
from safestart.proofs.strict import ProofRejected, exact, part, vector

SCHEMA = "safestart-proof-for-all/1"
_MOST, _MOST_CASES = 4096, 8192
Rationals = list[fmpq]


@dataclass(frozen=True, slots=True)
class StatedForAll:
    """A document's statement: intervals (low, high) as exact rationals, the box's half-widths, and its cases.

    GO: ``rates`` and ``motions`` are the nodes, ``cases`` the statements at each of them, ``half`` the half-widths that
    each history must bear. NO_GO: ``cases`` go with ``pieces``, intervals of the tumble rate.
    """

    verdict: str
    rates: Rationals
    motions: Rationals
    half: Rationals
    cases: list[Stated]
    pieces: list[Rationals]


def read(document: Any) -> StatedForAll:
    """The statement of a document; raise :class:`ProofRejected` when it is malformed."""
    statement.check_seal(document, SCHEMA)
    question, start = part(document, "question", dict), part(document, "start", dict)
    if question.get("kind") != "stay" or question.get("speed_limit") is not None:
        raise ProofRejected("kind: required stay without a speed limit")
    rates, motions, thrusts = (
        _ascending(question, key, 2, 2)
        for key in ("tumble_rate_rad_s", "mean_motion_rad_s", "max_acceleration_m_s2")
    )
    go = document.get("verdict") == "GO"
    plain = {
        "schema": statement.SCHEMA,
        "verdict": document.get("verdict"),
        "margin_m": document.get("margin_m"),
        "question": question
        | {
            "tumble_rate_rad_s": rates[1],
            "mean_motion_rad_s": motions[1],
            # The smaller disk lies in the larger: GO needs the least thrust, NO_GO the most.
            "max_acceleration_m_s2": thrusts[0 if go else 1],
        },
        "start": start,
    }
    half = _half_widths(start, part(question, "dimensions", int))
    return _go(document, plain, half, rates, motions) if go else _no_go(document, plain, half, rates, motions)


def _go(
    document: Mapping[str, Any],
    plain: dict[str, Any],
    half: Rationals,
    rates: list[float],
    motions: list[float],
) -> StatedForAll:
    at = [
        _nodes(document, "tumble_rates_rad_s", rates),
        _nodes(document, "mean_motions_rad_s", motions),
    ]
    witness, histories = document.get("witness"), part(document, "histories", list)
    if witness not in ("common", "per_corner"):
        raise ProofRejected(f"witness: required common or per_corner, received {str(witness)[:60]}")
    wide = [i for i, width in enumerate(half) if width > 0]
    required = [[0] * len(half)]
    if witness == "per_corner":
        required = []
        for ends in itertools.product((1, -1), repeat=len(wide)):
            sign = dict(zip(wide, ends, strict=True))
            required.append([sign.get(i, 0) for i in range(len(half))])
    corners = [part(history, "corner", list) for history in histories]
    if sorted(map(str, corners)) != sorted(map(str, required)):
        raise ProofRejected(
            f"histories: required one for each of {len(required)} corners, received {len(corners)}"
        )
    if len(histories) * len(at[0]) * len(at[1]) > _MOST_CASES:
        raise ProofRejected(f"histories, nodes: required at most {_MOST_CASES} pairs of them")
    cases = []
    for history, corner in zip(histories, corners, strict=True):
        stated = _plain(plain | {"thrust_m_s2": history.get("thrust_m_s2")})
        moved = [e + int(sign) * width for e, sign, width in zip(stated.start, corner, half, strict=True)]
        cases += [replace(stated, start=moved, w=w, n=n) for w, n in itertools.product(*at)]
    borne = half if witness == "common" else [fmpq(0)] * len(half)
    return StatedForAll("GO", at[0], at[1], borne, cases, [])


def _no_go(
    document: Mapping[str, Any],
    plain: dict[str, Any],
    half: Rationals,
    rates: list[float],
    motions: list[float],
) -> StatedForAll:
    cases, pieces, reached = [], [], rates[0]
    entries = part(document, "pieces", list)
    for entry in entries[:_MOST]:
        ends = _ascending(entry, "tumble_rate_rad_s", 2, 2)
        if ends[0] != reached:
            raise ProofRejected(
                f"pieces: required one from tumble rate {reached!r} rad/s on, received {ends[0]!r}"
            )
        reached = ends[1]
        pieces.append([exact(e, "tumble_rate_rad_s", 0.0) for e in ends])
        cases.append(_plain(plain | {"multipliers": entry.get("multipliers")}))
    if not entries or len(entries) > _MOST or reached != rates[1]:
        raise ProofRejected(
            f"pieces: required them up to tumble rate {rates[1]!r} rad/s, received up to {reached!r}"
        )
    of = [[exact(e, "interval", 0.0) for e in ends] for ends in (rates, motions)]
    return StatedForAll("NO_GO", of[0], of[1], half, cases, pieces)


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
        raise ProofRejected(f"{key}: required ascending numbers, received {str(values)[:60]}")
    return values


def _half_widths(start: Mapping[str, Any], d: int) -> Rationals:
    out = []
    for key in ("position_half_width_m", "velocity_half_width_m_s"):
        out += vector(start.get(key), key, d)
    if any(e < 0 for e in out):
        raise ProofRejected("position_half_width_m, velocity_half_width_m_s: required numbers >= 0")
    return out

"""Where one set is not inside another: shares, the worst cell of each pair, and the proof."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from safestart.engines.base import ResultCode
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.exact.prove import proof_of
from safestart.exact.question import Question
from safestart.model.metrics import ratio
from safestart.model.scenario import Floats
from safestart.processes.inclusion_chain.regions import Region, state_at
from safestart.processes.wire import DT_S, finite

_HELD = f"held over steps of {DT_S:g} s"
"""What a refutation says nothing beyond: thrust that changes within a step may do better."""
_IN = {
    "tube": f"a plan {_HELD} keeps {{:.2f}} m to every face of the tightened corridor",
    "analytical_tube": "meets the paper's conditions in the tightened scenario by {:.2f} m",
    "certified": "a known manoeuvre stays for ever with {:.2f} m to every face",
    "analytical": "meets the paper's conditions, which are not sound, by {:.2f} m",
    "synchronize": f"a thrust history {_HELD} reaches the hold point co-rotating with {{:.2f}} m to spare",
    "stay": f"a thrust history {_HELD} stays with {{:.2f}} m to every face",
    "hj_match": "value function {:.2f} m inside",
    "hj_position": "value function {:.2f} m inside",
    "exact_position": "thrust reaches the corridor at the horizon with {:.2f} m to spare",
}
_OUT = {
    "tube": f"no plan {_HELD} fits the tube: proved {{:.2f}} m short",
    "analytical_tube": "misses the paper's conditions in the tightened scenario: {:.2f} m short",
    "certified": "not certified: {:.2f} m short, which proves nothing",
    "analytical": "misses the paper's conditions: {:.2f} m short, which proves nothing",
    "synchronize": f"no thrust {_HELD} arrives co-rotating in time: proved {{:.2f}} m short",
    "stay": f"no thrust {_HELD} stays: proved {{:.2f}} m outside a face",
    "hj_match": "value function {:.2f} m outside, an error of unknown sign",
    "hj_position": "value function {:.2f} m outside, an error of unknown sign",
    "exact_position": "no thrust brings it to the corridor at the horizon: {:.2f} m short",
}


def pairs(regions: Mapping[str, Region]) -> dict[str, dict[str, float | None]]:
    """[inner][outer]: share of the inner cells outside the outer set; None for empty or failed sets."""
    return {a: {b: fraction(one, other) for b, other in regions.items()} for a, one in regions.items()}


def fraction(inner: Region, outer: Region) -> float | None:
    """Share of the inner set's cells that are known to be outside the outer set; undecided cells do not count."""
    if inner.code is not ResultCode.OK or outer.code is not ResultCode.OK:
        return None
    return ratio(int((inner.inside & outer.outside).sum()), int(inner.inside.sum()))


def counter_example(inner: Region, outer: Region, points: Floats, *, matched: bool) -> dict[str, Any] | None:
    """The cell of the inner set farthest outside the outer one, both margins, a proof; None without such a cell.

    ``matched``: whether a flight of `synchronize` ends slowly enough for `hj_match`.
    """
    cells = inner.inside & outer.outside
    if not cells.any():
        return None
    depth = np.where(cells, np.nan_to_num(outer.margin, nan=0.0), np.inf)
    cell = np.unravel_index(int(np.argmin(depth)), cells.shape)
    point = points[cell]
    kept, missed = float(inner.margin[cell]), float(outer.margin[cell])
    sides = [_IN[inner.name].format(kept), _OUT[outer.name].format(-missed)]
    if not np.isfinite(missed):
        sides[1] = f"not in {outer.name}: {outer.message}"
    if inner.name == "synchronize" and (
        outer.name == "hj_position" or (outer.name == "hj_match" and matched)
    ):
        sides.append("the flight of the proof reaches the target, so the level set is wrong here")
    proof = proof_at(outer.question, point)
    if proof is None:
        proof = proof_at(inner.question, point)
    return {
        "inner": inner.name,
        "outer": outer.name,
        "cells": int(cells.sum()),
        "x_m": float(point[0]),
        "y_m": float(point[1]),
        "inner_margin_m": finite(kept),
        "outer_margin_m": finite(missed),
        "evidence": "; ".join(sides),
        "proof": proof,
    }


def proof_at(question: Question | None, point: Floats) -> dict[str, Any] | None:
    """Proof document of the verdict at one start (2,), None without a question or a verdict."""
    if question is None:
        return None
    state = state_at(np.asarray(point))
    answer = decide(question, state)
    return None if answer.verdict is Verdict.UNDECIDED else proof_of(question, state, answer)

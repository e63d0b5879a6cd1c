"""One history for every member of a family, or one for each corner of its start box: the search for a GO."""

from __future__ import annotations

import itertools
import math

import numpy as np

from safestart.exact.answer import GUARD, Answer, Verdict
from safestart.exact.decide import decide
from safestart.exact.search import Search
from safestart.families.answer import TOLERANCE, Example, ForAll, History, Witness
from safestart.families.between import half_angle
from safestart.families.members import Family, corner_signs
from safestart.families.worst_member import (
    MOST_NODES,
    MOST_VALUES,
    Hostile,
    bend_of,
    hostile_of,
    samples_of,
)
from safestart.model.scenario import Floats

_ROUNDS = 40
# Neighbouring rates turn the corridor by at most twice this at T, so the rates between cost about a millimetre.
_TURN = 0.045
_MOST_EXAMPLES = 8


def one_history(family: Family, state: Floats, middle: Answer, witness: Witness, tolerance: float) -> ForAll:
    """GO if such histories are found, else UNDECIDED; ``middle`` is the answer of the middle member."""
    half = family.half
    corners = corner_signs(half) if witness == "per_corner" else np.zeros((1, len(half)))
    known = family.at_known_start() if witness == "per_corner" else family
    hostile, short = _at_nodes(known, [state + corner * half for corner in corners])
    if hostile is None:
        return ForAll(Verdict.UNDECIDED, math.nan, math.inf, witness, reason=short)
    lower, upper, histories = math.inf, math.inf, []
    for corner in corners:
        search = Search(hostile, state + corner * half)
        reason = _narrow(search, tolerance)
        upper = min(upper, search.upper)
        if search.lower <= GUARD:
            return _not_go(family, hostile, state, middle, witness, search, upper, reason)
        assert search.thrust is not None
        lower = min(lower, search.lower)
        histories.append(History(tuple(int(e) for e in corner), search.thrust))
    return ForAll(
        Verdict.GO, lower, upper, witness, tuple(histories), rates=hostile.rates, motions=hostile.motions
    )


def _at_nodes(family: Family, starts: list[Floats]) -> tuple[Hostile | None, str]:
    """The family at enough rates and mean motions; None with the reason if these would be too many."""
    turn = half_angle(family.rates, family.question.horizon)
    bend = max(bend_of(family, start) for start in starts)
    width = family.motions[1] - family.motions[0]
    parts = max(1, math.ceil(turn / _TURN))
    motion_parts = max(1, math.ceil(width * math.sqrt(bend / (8.0 * TOLERANCE))))
    count = (parts + 1) * (motion_parts + 1)
    values = count * len(corner_signs(family.half)) * samples_of(family)
    if count > MOST_NODES or values > MOST_VALUES:
        few = "tumble rates" if parts > motion_parts else "mean motions"
        return None, f"the {few} differ too much for so long a horizon: a proof would take {count} nodes"
    return hostile_of(family, parts, motion_parts), ""


def _narrow(search: Search, tolerance: float) -> str:
    """Run rounds until the bracket is narrow or no history can serve all; returns the reason if neither happens."""
    if search.distance_now < -GUARD:
        search.upper = search.distance_now
        return ""
    for _ in range(_ROUNDS):
        failed = search.round()
        if failed:
            return failed
        if search.upper < -GUARD or search.upper - search.lower <= tolerance or not search.cut(tolerance):
            break
    return ""


def _not_go(
    family: Family,
    hostile: Hostile,
    state: Floats,
    middle: Answer,
    witness: Witness,
    search: Search,
    upper: float,
    reason: str,
) -> ForAll:
    """UNDECIDED, with a NO_GO member if one of the worst corners is one."""
    if reason:
        return ForAll(Verdict.UNDECIDED, math.nan, upper, witness, reason=reason)
    here = Example(family.question, state, middle)
    for rate, motion, start in _suspects(family, hostile, search):
        question = family.member(rate, motion, family.thrusts[0])
        answer = decide(question, start, verdict_only=True)
        if answer.verdict is Verdict.NO_GO:
            there = Example(question, start, answer)
            text = "the verdict depends on which member is true: the middle is GO, the second example NO_GO"
            return ForAll(Verdict.UNDECIDED, math.nan, upper, witness, examples=(here, there), reason=text)
    if upper < -GUARD:
        serves = "no one history serves all members" if witness == "common" else "no history serves a corner"
        text = f"{serves} (at best {-upper:.3g} m outside a face), and every member looked at is GO"
    else:
        text = "0 lies between the bounds"
    return ForAll(Verdict.UNDECIDED, math.nan, upper, witness, examples=(here,), reason=text)


def _suspects(family: Family, hostile: Hostile, search: Search) -> list[tuple[float, float, Floats]]:
    """Members likely to be NO_GO: the ends of the parameters, with the start that the multipliers bound lowest."""
    starts = [search.state]
    if search.evidence is not None:
        cuts = hostile.cuts(search.evidence.times, search.evidence.faces)
        pull = search.evidence.weights @ cuts.start
        starts.insert(0, search.state - hostile.half * np.sign(pull))
    else:
        # The start box reaches outside already: take the member whose start is farthest out.
        d = family.question.dimensions
        nearest = int(np.argmin(hostile.offsets - hostile.normals @ search.state[:d]))
        away = np.zeros_like(hostile.half)
        away[:d] = np.sign(hostile.normals[nearest])
        starts.insert(0, search.state + hostile.half * away)
    ends = itertools.product(starts, dict.fromkeys(family.rates), dict.fromkeys(family.motions))
    return [(rate, motion, start) for start, rate, motion in ends][:_MOST_EXAMPLES]

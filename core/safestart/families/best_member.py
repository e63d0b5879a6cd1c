"""The best member of a family: the start joins the thrust as a variable, and multipliers bound every member at once.

For times t_j, faces i_j and weights lambda_j >= 0 of sum 1 no history of a member keeps more than

    F(w, n) = sum_j lambda_j (offset_j + start_j . c) + sum_i half_i |sum_j lambda_j start_ji|
              + a_max sum_k |sum_j lambda_j thrust_jk| ,

the rows taken at its tumble rate w and mean motion n, a_max the upper end. F is the largest of smooth functions of
(w, n), whose second derivatives are bounded (``between.py``): values at a few nodes bound it on a whole interval.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from safestart.exact.answer import GUARD, Answer, Evidence, Verdict
from safestart.exact.decide import decide
from safestart.exact.norm_rows import Blocks, blocks
from safestart.exact.search import Search
from safestart.exact.watch import Cuts, Ints, Minima, Watch
from safestart.families.answer import TOLERANCE, Example, ForAll, Piece, Witness
from safestart.families.between import Reach, nodes, reach
from safestart.families.members import Family, Interval
from safestart.model.scenario import Floats
from safestart.optim.thrust_ball import bound

# The nodes take at most this part of a margin, or a millimetre.
_SHARE, _LEAST_M, _MOST_PARTS = 0.05, 1e-3, 64
_MOST_PIECES, _ROUNDS = 64, 40


class Friendly:
    """One member (rate, motion) with the largest thrust and the start free in the box, as a watch.

    Its thrust histories are (N + 2 d, d): N thrusts, then for each axis of the box a row whose first entry, in units of
    a_max, says where the start lies between the ends.
    """

    rounding = Watch.rounding

    def __init__(self, family: Family, rate: float, motion: float) -> None:
        self.question = family.member(rate, motion, family.thrusts[1])
        self.watch = Watch(self.question)
        self.half = family.half
        self.a_max = family.thrusts[1]
        self.names, self.normals = self.watch.names, self.watch.normals
        self.prediction = self.watch.prediction
        held = np.abs(self.normals) @ self.half[: self.question.dimensions]
        self.offsets = self.watch.offsets + held

    def cuts(self, times: Floats, faces: Ints) -> Cuts:
        """Rows whose last columns move the start."""
        cuts = self.watch.cuts(times, faces)
        moves = np.zeros((len(times), len(self.half), self.question.dimensions))
        moves[:, :, 0] = cuts.start * self.half / self.a_max
        thrust = np.concatenate([cuts.thrust, moves.reshape(len(times), -1)], axis=1)
        return Cuts(times, faces, cuts.offset, cuts.start, thrust)

    def blocks(self, names: Sequence[str], times: Floats) -> Blocks:
        """Rows of the norm limits ``names`` (B) at ``times`` (B,)."""
        return blocks(self.question, self.prediction, names, times)

    def minima(self, state: Floats, thrust: Floats) -> Minima:
        """The flight from the start that was chosen."""
        return self.watch.minima(self.start(state, thrust), thrust[: self.question.steps])

    def start(self, state: Floats, thrust: Floats) -> Floats:
        """The start (2 d,) that a history chose in the box around ``state``."""
        out: Floats = state + self.half * np.clip(thrust[self.question.steps :, 0] / self.a_max, -1.0, 1.0)
        return out


def reach_of(family: Family, state: Floats) -> Reach:
    """Bounds on all flights of the family, with the largest thrust."""
    d, half = family.question.dimensions, family.half
    far = float(np.linalg.norm(state[:d]) + np.linalg.norm(half[:d]))
    fast = float(np.linalg.norm(state[d:]) + np.linalg.norm(half[d:]))
    return reach(far, fast, family.thrusts[1], family.motions[1], family.question.horizon)


def over_interval(
    family: Family, state: Floats, evidence: Evidence, rates: Interval, rounding: float
) -> tuple[float, float, float]:
    """Bound (m) of all members with a rate in ``rates`` by one evidence; the worst node (w, n)."""
    kept = evidence.weights > 0.0
    times, faces, weights = evidence.times[kept], evidence.faces[kept], evidence.weights[kept]
    bounds = reach_of(family, state)
    spin = float(weights @ (times**2 * bounds.within(times)))
    first = [
        _value(family, state, times, faces, weights, w, n) for w in set(rates) for n in set(family.motions)
    ]
    allowed = max(_LEAST_M, -_SHARE * max(first))
    rate_parts = _parts(rates[1] - rates[0], spin, allowed)
    motion_parts = _parts(family.motions[1] - family.motions[0], bounds.bend, allowed)
    worst = (-math.inf, rates[0], family.motions[0])
    for w in nodes(*rates, rate_parts):
        for n in nodes(*family.motions, motion_parts):
            worst = max(worst, (_value(family, state, times, faces, weights, w, n), w, n))
    between = ((rates[1] - rates[0]) / rate_parts) ** 2 / 8.0 * spin
    between += ((family.motions[1] - family.motions[0]) / motion_parts) ** 2 / 8.0 * bounds.bend
    return worst[0] + between + rounding, worst[1], worst[2]


def _parts(width: float, curvature: float, allowed: float) -> int:
    return min(_MOST_PARTS, max(1, math.ceil(width * math.sqrt(curvature / (8.0 * allowed)))))


def _value(
    family: Family, state: Floats, times: Floats, faces: Ints, weights: Floats, rate: float, motion: float
) -> float:
    member = Friendly(family, rate, motion)
    cuts = member.cuts(times, faces)
    constant = cuts.offset + cuts.start @ state
    return bound(constant, cuts.thrust, weights, member.a_max, family.question.dimensions)


def no_history(family: Family, state: Floats, middle: Answer, witness: Witness) -> ForAll:
    """NO_GO where multipliers refute every member, else UNDECIDED; ``middle`` is the answer of the middle member."""
    work, pieces = [family.rates], []
    motion = family.question.scenario.target.mean_motion
    here = Example(family.question, state, middle)
    while work:
        rates = work.pop()
        centre = 0.5 * (rates[0] + rates[1])
        search, example = _best(family, state, centre, motion)
        if search is None or search.evidence is None:
            return _not_no_go(here, example, witness)
        upper, rate, worst = over_interval(family, state, search.evidence, rates, search.rounding)
        if upper < -GUARD:
            pieces.append(Piece(rates, search.evidence.multipliers(search.watch.names), upper))
            continue
        search, example = _best(family, state, rate, worst)
        if example is not None:
            return _not_no_go(here, example, witness)
        if rates[0] == rates[1] or len(work) + len(pieces) >= _MOST_PIECES:
            return _not_no_go(here, None, witness)
        work += [(centre, rates[1]), (rates[0], centre)]
    margin = max(piece.upper for piece in pieces)
    return ForAll(Verdict.NO_GO, margin, math.inf, witness, pieces=tuple(pieces))


def _best(family: Family, state: Floats, rate: float, motion: float) -> tuple[Search | None, Example | None]:
    """Multipliers for the best start of one member, or that start where it is GO; neither where 0 is between."""
    friendly = Friendly(family, rate, motion)
    search = Search(friendly, state)
    for _ in range(_ROUNDS):
        if search.round() or search.lower > GUARD:
            break
        # Close enough for the bound on an interval to be worth trying.
        if search.upper - search.lower <= max(TOLERANCE, -0.02 * search.upper) or not search.cut(TOLERANCE):
            break
    if search.lower > GUARD and search.thrust is not None:
        start = friendly.start(state, search.thrust)
        answer = decide(friendly.question, start, verdict_only=True)
        return None, Example(friendly.question, start, answer) if answer.verdict is Verdict.GO else None
    return (search if search.upper < -GUARD else None), None


def _not_no_go(here: Example, example: Example | None, witness: Witness) -> ForAll:
    examples: tuple[Example, ...] = (here,)
    text = "0 lies between the bounds of some members; those looked at are NO_GO"
    if example is not None:
        examples = (here, example)
        text = "the verdict depends on which member is true: the middle is NO_GO, the second example GO"
    return ForAll(Verdict.UNDECIDED, math.nan, math.inf, witness, examples=examples, reason=text)

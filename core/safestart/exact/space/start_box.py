"""`stay` for all members of a set: one thrust history for all of them, or none for any start.

Every distance is affine in the start, so of a box c +- h the worst start takes sum_i |start_i| h_i from a row, and the
best adds as much. What is unknown beside the start takes what :mod:`safestart.exact.space.tightened` says. GO: one
history keeps every row less that. NO_GO: no history does, for what is stated, with the start free in the box.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from safestart.errors import invalid
from safestart.exact.answer import BETWEEN, GUARD, TOLERANCE, Answer, Verdict
from safestart.exact.norm_rows import Blocks
from safestart.exact.search import Search
from safestart.exact.space.question import SpaceQuestion
from safestart.exact.space.tightened import TightenedWatch
from safestart.exact.space.unknowns import KNOWN
from safestart.exact.space.watch import SpaceWatch, space_watch_of
from safestart.exact.watch import Cuts, Ints, Minima
from safestart.model.scenario import Floats, number

MAX_HALF_WIDTH = 1000.0
# Minima of several corners this close in time (s) cut with one row.
_SAME_S = 0.05


class _Watched:
    """The watch of the question, and the half-widths (6,)."""

    def __init__(self, watch: SpaceWatch, half: Floats) -> None:
        self.watch, self.half = watch, half
        self.question, self.rounding = watch.question, watch.rounding
        self.names, self.normals = watch.names, watch.normals
        self.near = np.abs(watch.normals) @ half[:3]
        self.offsets = watch.offsets

    def blocks(self, names: Sequence[str], times: Floats) -> Blocks:
        """The watch's rows: a question about a box has no other limits."""
        return self.watch.blocks(names, times)


class _Worst(_Watched):
    """The rows of the worst start at each time and face."""

    def __init__(self, watch: SpaceWatch, half: Floats) -> None:
        super().__init__(watch, half)
        self.offsets = watch.offsets - self.near
        wide = [(-e, e) if e > 0.0 else (0.0,) for e in half.tolist()]
        self.corners = np.array(list(product(*wide)))

    def cuts(self, times: Floats, faces: Ints) -> Cuts:
        """Rows less what the box takes from them."""
        cuts = self.watch.cuts(times, faces)
        return Cuts(times, faces, cuts.offset - np.abs(cuts.start) @ self.half, cuts.start, cuts.thrust)

    def minima(self, state: Floats, thrust: Floats) -> Minima:
        """Of the flights from all corners; between the corners no distance is smaller."""
        found = [self.watch.minima(state + corner, thrust) for corner in self.corners]
        times, faces, values = (
            np.concatenate([getattr(one, name) for one in found]) for name in ("times", "faces", "values")
        )
        order = np.argsort(values)
        place = np.stack([np.rint(times[order] / _SAME_S).astype(np.int64), faces[order]])
        first = np.sort(np.unique(place, axis=1, return_index=True)[1])
        kept = order[first]
        return Minima(min(one.lowest for one in found), times[kept], faces[kept], values[kept])


class _Best(_Watched):
    """The start free in the box, as six more rows of thrust: its share of each half-width, in units of the scale."""

    def __init__(self, watch: SpaceWatch, half: Floats) -> None:
        super().__init__(watch, half)
        self.offsets = watch.offsets + self.near

    def cuts(self, times: Floats, faces: Ints) -> Cuts:
        """Rows whose last columns move the start."""
        cuts, question = self.watch.cuts(times, faces), self.question
        moves = np.zeros((len(times), 6, question.channels))
        moves[:, :, 0] = cuts.start * self.half / question.thrust_scale
        if question.thrust.kind == "thrusters":
            # Shares are not negative: the second one moves the other way.
            moves[:, :, 1] = -moves[:, :, 0]
        thrust = np.concatenate([cuts.thrust, moves.reshape(len(times), -1)], axis=1)
        return Cuts(times, faces, cuts.offset, cuts.start, thrust)

    def minima(self, state: Floats, thrust: Floats) -> Minima:
        """The flight from the start that was chosen."""
        moved = thrust[self.question.steps :] / self.question.thrust_scale
        share = moved[:, 0] - (moved[:, 1] if self.question.thrust.kind == "thrusters" else 0.0)
        start = state + self.half * np.clip(share, -1.0, 1.0)
        return self.watch.minima(start, thrust[: self.question.steps])


def decide_from_box(
    question: SpaceQuestion, state: Floats, half: Floats, *, tolerance: float = TOLERANCE
) -> Answer:
    """Answer `stay` for every start of ``state`` +- ``half`` (6,), LVLH position (m) and velocity (m/s), and unknowns.

    GO: ``thrust`` keeps ``lower`` from every start, for every member of the question's unknowns. NO_GO: ``multipliers``
    show that from no start any history keeps more than ``upper``, were the unknowns 0. UNDECIDED otherwise, mostly
    because the verdict depends on the member. Raises ``InvalidInput`` for another question and half-widths out of
    range.
    """
    state, half = np.asarray(state, dtype=np.float64), np.asarray(half, dtype=np.float64)
    if not question.plain:
        raise invalid(
            "question", "stay without a speed limit or demands where half-widths are given", question.kind
        )
    if half.shape != (6,):
        raise invalid("half_width", "six numbers", half.shape)
    for value in half.tolist():
        number("half_width", value, 0.0, MAX_HALF_WIDTH)
    watch = space_watch_of(replace(question, unknowns=KNOWN))
    tight = TightenedWatch(space_watch_of(question), state) if question.unknowns else watch
    worst = Search(_Worst(tight, half), state)
    bounded = not isinstance(tight, TightenedWatch) or math.isfinite(tight.widest)
    if bounded and worst.distance_now >= -GUARD:
        unknown = tight if isinstance(tight, TightenedWatch) else None
        worst.narrow(tolerance if unknown is None else max(tolerance, unknown.reserve(half, state, None)))
        lower = worst.lower - (0.0 if unknown is None else unknown.reserve(half, state, worst.thrust))
        if lower > GUARD:
            return Answer(Verdict.GO, lower, lower, worst.upper, worst.thrust, (), worst.rounds)
    best = Search(_Best(watch, half), state)
    if best.distance_now < -GUARD:
        now = best.distance_now
        return Answer(Verdict.NO_GO, now, -math.inf, now, None, (best.now,), worst.rounds)
    best.narrow(tolerance)
    rounds = worst.rounds + best.rounds
    if best.upper < -GUARD and best.evidence is not None:
        proof = best.evidence.multipliers(watch.names)
        return Answer(Verdict.NO_GO, best.upper, -math.inf, best.upper, None, proof, rounds)
    upper = min(worst.upper, worst.distance_now)
    if best.lower <= GUARD:
        reason = BETWEEN
    elif isinstance(tight, TightenedWatch):
        reason = f"a thrust history keeps {best.lower:.2f} m where all is as stated; {tight.told}"
    elif worst.distance_now < -GUARD or worst.upper < -GUARD:
        reason = "no single thrust history stays from every start of the box, and one stays from some of them"
    else:
        reason = BETWEEN
    return Answer(Verdict.UNDECIDED, math.nan, worst.lower, upper, None, (), rounds, reason)

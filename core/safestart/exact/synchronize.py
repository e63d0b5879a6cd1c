"""`synchronize`: the end T is any number of intervals; GO needs one T that succeeds, NO_GO a refutation of each.

Branch and bound over T. Solving the program of one T gives multipliers that bound the margin of every other T, too: the
rows at times up to T keep their weights, the rows of the end move to the new end. The remaining T are solved in turn,
the highest bound first. A few programs refute a hundred ends.
"""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from itertools import groupby

import numpy as np

from safestart.exact.answer import GUARD, Answer, Evidence, Part, Verdict
from safestart.exact.arrival import arrival_of
from safestart.exact.cut_source import Ending
from safestart.exact.limits import AT_END
from safestart.exact.norm_rows import end_blocks
from safestart.exact.search import Search
from safestart.exact.watch import Watch
from safestart.model.scenario import Bools, Floats

# Refuted ends are solved only to a tenth of their margin: the verdict is certain, and the worst end sets the bound.
_SHARE = 0.1


def synchronize(watch: Watch, state: Floats, tolerance: float, *, verdict_only: bool = False) -> Answer:
    """Answer `synchronize` for one start ``state`` (2 d,), as :func:`safestart.exact.decide.decide` does.

    A GO says what holds after its end, where that is proved.
    """
    answer = ended(watch, state, tolerance, verdict_only=verdict_only)
    if answer.verdict is not Verdict.GO or answer.thrust is None:
        return answer
    question, end = watch.question, len(answer.thrust)
    last = watch.until(end).prediction.flight(state, answer.thrust)[-1, -1]
    arrival = arrival_of(question, last, end * question.dt)
    if arrival is None and verdict_only:
        # The flight that proves the verdict first may end by a face; the best one ends well inside.
        return synchronize(watch, state, tolerance)
    return replace(answer, arrival=arrival)


def ended(watch: Ending, state: Floats, tolerance: float, *, verdict_only: bool = False) -> Answer:
    """The same, whatever comes after the end, for any watch that can end earlier."""
    ends = _Ends(watch, state)
    reason = ""
    while (steps := ends.most_hopeful()) is not None:
        search = Search(watch.until(steps), state)
        if search.distance_now < -GUARD:
            parts = (Part(ends.first, ends.last, (search.now,)),)
            now = search.distance_now
            return Answer(Verdict.NO_GO, now, -math.inf, now, None, (), ends.rounds, parts=parts)
        reason = search.narrow(tolerance, verdict_only=verdict_only, share=_SHARE)
        ends.note(steps, search)
        if ends.lower > GUARD:
            break
    return ends.answer(reason)


@lru_cache(maxsize=4)
def end_rows(watch: Ending) -> tuple[Floats, Floats, Floats]:
    """The rows of the limits at every end, kept between calls."""
    return end_blocks(watch)


class _Ends:
    """Bounds for each end T = k dt: ``upper`` (K + 1,) in metres, and the multipliers that prove it."""

    def __init__(self, watch: Ending, state: Floats) -> None:
        question = watch.question
        goal = question.goal
        self.watch, self.state = watch, state
        self.first, self.last = (goal.earliest if goal else 1), question.steps
        # No margin exceeds the ball's radius.
        self.upper = np.full(self.last + 1, goal.radius if goal else np.inf)
        self.upper[: self.first] = -np.inf
        self.solved = np.zeros(self.last + 1, dtype=bool)
        self.source = np.full(self.last + 1, -1)
        self.evidence: list[Evidence] = []
        self.lower, self.rounds = -math.inf, 0
        self.thrust: Floats | None = None

    def most_hopeful(self) -> int | None:
        """The end with the highest bound among those neither refuted nor solved; the latest one in a tie."""
        open_ends = np.nonzero((self.upper >= -GUARD) & ~self.solved)[0]
        if not len(open_ends):
            return None
        return int(open_ends[len(open_ends) - 1 - int(np.argmax(self.upper[open_ends][::-1]))])

    def note(self, steps: int, search: Search) -> None:
        """Record the bracket of one end, and the bounds that its multipliers give for the others."""
        self.solved[steps] = True
        self.rounds += search.rounds
        if search.lower > self.lower:
            self.lower, self.thrust = search.lower, search.thrust
        if search.evidence is None:
            return
        evidence = search.evidence.until(search.watch.question.latest)
        bounds = self._carried(evidence) + search.rounding
        better = bounds < self.upper
        self.upper[better], self.source[better] = bounds[better], len(self.evidence)
        self.evidence.append(evidence)

    def _carried(self, evidence: Evidence) -> Floats:
        """Bounds (K + 1,) on the margins of all ends from the multipliers of one, with its end rows moved to theirs."""
        question = self.watch.question
        d, columns, faces = question.dimensions, self.last * question.channels, len(evidence.faces)
        names, cone = evidence.blocks.names, question.dimensions + 1
        at_end = np.array([name in AT_END for name in names], dtype=bool)
        holds = np.concatenate([np.ones(faces), np.tile(np.r_[1.0, np.zeros(d)], len(names))])
        times = np.concatenate([evidence.times, np.repeat(evidence.blocks.times, cone)])
        path = np.concatenate([np.ones(faces, dtype=bool), np.repeat(~at_end, cone)])
        path &= evidence.weights != 0.0
        weights = np.where(self._before(times[path]), evidence.weights[path], 0.0)
        rows = np.zeros((int(path.sum()), columns))
        rows[:, : evidence.rows.shape[1]] = evidence.rows[path]
        end = evidence.weights[faces:].reshape(-1, cone)[at_end].ravel()
        offset, start, thrust = end_rows(self.watch)
        pull = weights @ rows + np.einsum("kbc,b->kc", thrust, end)
        reach = question.thrust_set.support(pull.reshape(self.last + 1, -1, question.channels))
        level = weights @ evidence.constant[path] + offset @ end + (start @ self.state) @ end
        total = weights @ holds[path] + float(end[::cone].sum())
        level += question.thrust_scale * reach
        out: Floats = np.divide(level, total, out=np.full(self.last + 1, np.inf), where=total > 0.0)
        return out

    def _before(self, times: Floats) -> Bools:
        """(K + 1, J): whether the times (J,) are not after the ends; exact arithmetic decides close cases."""
        dt = self.watch.question.dt
        ends = dt * np.arange(self.last + 1)[:, None]
        out = np.asarray(times <= ends)
        for k, j in np.argwhere(np.abs(times - ends) < 1e-9 * (1.0 + ends)).tolist():
            out[k, j] = Fraction(times[j]) <= Fraction(dt) * k
        return out

    def answer(self, reason: str) -> Answer:
        """GO if an end succeeds, NO_GO if every end is refuted, else UNDECIDED."""
        upper = float(self.upper.max())
        if self.lower > GUARD:
            return Answer(Verdict.GO, self.lower, self.lower, upper, self.thrust, (), self.rounds)
        if upper < -GUARD:
            return Answer(Verdict.NO_GO, upper, self.lower, upper, None, (), self.rounds, parts=self._parts())
        finite = math.isfinite(self.lower) and math.isfinite(upper)
        middle = 0.5 * (self.lower + upper) if finite else math.nan
        return Answer(Verdict.UNDECIDED, middle, self.lower, upper, self.thrust, (), self.rounds, reason)

    def _parts(self) -> tuple[Part, ...]:
        names, out = self.watch.names, []
        for source, group in groupby(range(self.first, self.last + 1), lambda k: int(self.source[k])):
            ends = list(group)
            out.append(Part(ends[0], ends[-1], self.evidence[source].multipliers(names)))
        return tuple(out)

"""The critical abort time: a time up to which every abort is proved safe, and one at which an abort collides."""

from __future__ import annotations

from dataclasses import dataclass, replace

from safestart.passive_safety import requirements
from safestart.passive_safety.flights.falsify import Drifting, closest
from safestart.passive_safety.question import Question
from safestart.passive_safety.reach.reach_set import Reach, reach
from safestart.passive_safety.verify import bracket, collides, prove_separation
from safestart.runtime.progress import Context

TOLERANCE = 0.05
"""Width (min) at which both bisections stop."""


@dataclass(frozen=True, slots=True)
class CriticalAbort:
    """``proved_until`` (min): every abort from ``first`` to it is proved safe; None: not even at ``first``.

    ``example``: a drift into the box after the earliest abort at which the search found one; None: none was found.
    The critical time lies between the two. Contacts later than the question's horizon do not count.
    """

    first: float
    last: float
    proved_until: float | None
    example: Drifting | None
    reason: str = ""


def critical_abort(
    question: Question, first: float, last: float, context: Context | None = None
) -> CriticalAbort:
    """Bisect the end of an abort window from ``first`` to at most ``last`` (min), by proofs and by flights.

    The question's horizon should leave the drifts after ``last`` time to arrive; its own window is not used.
    """
    context = context or Context()
    whole = replace(question, window=(first, last))
    tubes = reach(whole)
    reason = tubes.entry.reason or requirements.stays_in_mode_2(tubes, question.system.guard)
    example = _example(whole, tubes, first, last)
    end = last if example is None else example.abort
    proved = None if reason else _proved(whole, tubes, first, end, context)
    return CriticalAbort(first, last, proved, example, reason)


def _proved(question: Question, tubes: Reach, first: float, last: float, context: Context) -> float | None:
    """Largest proved end of the window, up to ``last``; None: not even ``first`` alone."""

    def safe(low: float, high: float) -> bool:
        return not len(prove_separation(replace(question, window=(low, high)), tubes, context).open)

    if not safe(first, first):
        return None
    if question.window == (first, last) and safe(first, last):
        return last
    low, high = first, last
    while high - low > TOLERANCE:
        # Aborts before ``low`` are proved already.
        middle = 0.5 * (low + high)
        low, high = (middle, high) if safe(low, middle) else (low, middle)
    return low


def _example(question: Question, tubes: Reach, first: float, last: float) -> Drifting | None:
    def found(high: float) -> Drifting | None:
        drift = closest(question, (first, high), 0, bracket(tubes), question.box * (1.0 - 1e-6))
        return drift if drift.max_norm < question.box and collides(question, drift) else None

    best = found(last)
    if best is None:
        return None
    low = first
    while best.abort - low > TOLERANCE:
        middle = 0.5 * (low + best.abort)
        earlier = found(middle)
        if earlier is None:
            low = middle
        else:
            best = earlier
    return best

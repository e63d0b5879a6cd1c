"""Safe-abort map (paper 003, Fig. 5): per start, the time up to which every abort is proved safe."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from safestart.passive_safety import requirements
from safestart.passive_safety.question import Question
from safestart.passive_safety.reach.reach_set import Reach, reach
from safestart.passive_safety.verify import prove_separation
from safestart.runtime.progress import Context

_REAL = ("los", "thrust")
"""Requirements that starts beside the cone or far away really break."""

_CUTS = 2


@dataclass(frozen=True, slots=True)
class SafeUntil:
    """Time (min) up to which every abort is proved, in whole windows; 0: not even the first window.

    ``separation``: apart from the target's box. ``requirements``: also thrust, line of sight and speed octagon up to
    that time. ``reason``: what ended the proof of the powered flight early, or empty.
    """

    separation: float
    requirements: float
    reason: str = ""


def safe_until(
    question: Question, windows: int, context: Context | None = None, cuts: int = _CUTS
) -> SafeUntil:
    """Largest end of the ``windows`` equal parts of [0, window end] up to which the proofs of ``question`` go through.

    Contacts later than the question's horizon do not count. Too wide sets are quartered ``cuts`` times.
    """
    context = context or Context()
    found = _of_the_whole(question, windows, context)
    if not found.reason or found.reason in _REAL or cuts == 0:
        return found
    # A proof that fails only because the set is too wide may succeed for its quarters.
    parts = [safe_until(quarter, windows, context, cuts - 1) for quarter in _quarters(question)]
    reason = "; ".join(sorted({part.reason for part in parts if part.reason}))
    return SafeUntil(min(p.separation for p in parts), min(p.requirements for p in parts), reason)


def _quarters(question: Question) -> list[Question]:
    """The initial set cut in x and in y."""
    x, y, vx, vy = question.centre
    a, b, c, d = (0.5 * question.half[0], 0.5 * question.half[1], *question.half[2:])
    return [
        replace(question, centre=(x + i * a, y + j * b, vx, vy), half=(a, b, c, d))
        for i in (-1, 1)
        for j in (-1, 1)
    ]


def _of_the_whole(question: Question, windows: int, context: Context) -> SafeUntil:
    assert question.window is not None
    last = question.window[1]
    whole = replace(question, window=(0.0, last))
    tubes = reach(whole)
    reason = tubes.entry.reason or requirements.stays_in_mode_2(tubes, question.system.guard)
    # Then only aborts before the entry are proved.
    most = _floor(min(last, tubes.entry.first), last, windows) if reason else windows
    apart = _separated(whole, tubes, most, windows, context)
    doubt, name = requirements.first_doubt(tubes)
    held = min(apart, _floor(doubt, last, windows))
    return SafeUntil(apart * last / windows, held * last / windows, reason or name)


def _floor(time: float, last: float, windows: int) -> int:
    """The number of whole windows that end before ``time``."""
    return max(0, min(windows, math.floor(time * windows / last))) if math.isfinite(time) else windows


def _separated(question: Question, tubes: Reach, most: int, windows: int, context: Context) -> int:
    """The number of windows, counted from the first up to ``most``, that are all proved."""
    assert question.window is not None
    last = question.window[1]

    low, fails, high = 0, most + 1, most
    while low < high < fails:
        between = (low * last / windows, high * last / windows)
        left = prove_separation(replace(question, window=between), tubes, context)
        if not len(left.open):
            low = high
        else:
            # This run also proves the windows that end before the earliest open abort.
            low = max(low, min(_floor(float(left.open[:, 0].min()), last, windows), high - 1))
            # Open cells of the finest grid stay open; coarser ones are open only because they were too many.
            fails = high if left.gave_up else low + 1
        high = low + (fails - low) // 2
    return low

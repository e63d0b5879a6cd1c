"""The reach set of one question: mode 1, then one mode-2 branch per guard face that may be crossed."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from safestart.verification.crossing import Crossing, Entry, find_entry
from safestart.verification.model import Mode
from safestart.verification.question import Question
from safestart.verification.tube import Tube, propagate

FAR_STEP = Fraction(1, 5)
EARLY_STEP, EARLY_STEPS = Fraction(1, 40), 64
"""Mode 2 starts with a transient of 3 seconds; after 1.6 min only the slow motion is left."""
LATE_START, LATE_STEP = EARLY_STEP * EARLY_STEPS, Fraction(1, 4)
_FIRST_TRY = 160.0
_BEYOND = 60.0


@dataclass(frozen=True, slots=True)
class Mutation:
    """What the mutation tests leave out (``curvature`` and ``remainder`` are scales); the default is the proof."""

    curvature: float = 1.0
    remainder: float = 1.0
    bins: bool = True


PROOF = Mutation()
"""Nothing left out."""


@dataclass(frozen=True, slots=True)
class Branch:
    """Mode 2 after one crossing: time since the crossing in the tubes ``early`` and ``late``."""

    crossing: Crossing
    early: Tube
    late: Tube

    def tubes(self) -> tuple[Tube, Tube]:
        """Both, in order."""
        return self.early, self.late


@dataclass(frozen=True, slots=True)
class Reach:
    """``far``: mode 1 up to the last entry; ``entry``; ``branches`` of mode 2, each up to the end of the question."""

    far: Tube
    entry: Entry
    branches: tuple[Branch, ...]


def reach(question: Question, mutation: Mutation = PROOF) -> Reach:
    """Reach tubes until the engines fail for good or the horizon ends; see ``Entry.reason`` where that failed."""
    centre, gens = question.set()
    end = question.horizon if question.window is None else question.window[1]
    entry, tube = Entry(0.0, 0.0, ()), None
    for length in (min(_FIRST_TRY, question.horizon + _BEYOND), question.horizon + _BEYOND):
        steps = int(length / FAR_STEP)
        tube = propagate(Mode.FAR, centre, gens, Fraction(0), FAR_STEP, steps, mutation.curvature)
        entry = find_entry(tube, centre, gens, question.horizon, mutation.remainder)
        if entry.branches:
            break
    assert tube is not None
    branches = []
    for crossing in entry.branches:
        left = end - crossing.first
        if left <= 0.0:
            continue
        late_steps = max(0, int((left - float(LATE_START)) / float(LATE_STEP)) + 1)
        state = crossing.centre, crossing.gens
        branches.append(
            Branch(
                crossing,
                propagate(Mode.NEAR, *state, Fraction(0), EARLY_STEP, EARLY_STEPS, mutation.curvature),
                propagate(Mode.NEAR, *state, LATE_START, LATE_STEP, late_steps, mutation.curvature),
            )
        )
    return Reach(tube.until(min(entry.last, end)), entry, tuple(branches))

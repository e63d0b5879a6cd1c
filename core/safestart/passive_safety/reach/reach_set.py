"""The reach set of one question: mode 1, then one mode-2 branch per guard face that may be crossed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from safestart.passive_safety.model import Mode, Motion
from safestart.passive_safety.question import Question
from safestart.passive_safety.reach.abort_clock import Clock
from safestart.passive_safety.reach.crossing import Crossing
from safestart.passive_safety.reach.entry import Entry, find_entry
from safestart.passive_safety.reach.tube import Tube, propagate

FAR_STEP = Fraction(1, 5)
PHASES = (
    (Fraction(0), Fraction(1, 160)),
    (Fraction(2, 5), Fraction(1, 40)),
    (Fraction(8, 5), Fraction(1, 4)),
)
"""Mode 2, start and step (min): a transient of 3 seconds; its remainder; the slow motion, to the end."""
_FIRST_TRY = 160.0
_BEYOND = 60.0


@dataclass(frozen=True, slots=True)
class Branch:
    """Mode 2 after one crossing: consecutive ``tubes`` over the time since the crossing."""

    crossing: Crossing
    tubes: tuple[Tube, ...]

    @property
    def clock(self) -> Clock:
        """Abort time of a state of mode 2: the time since the crossing plus this."""
        return Clock(self.crossing.time, self.crossing.time_gens, self.crossing.time_radius)


@dataclass(frozen=True, slots=True)
class Reach:
    """``far``: mode 1 up to the last entry; ``entry``; ``branches`` of mode 2, each up to the end of the question."""

    far: Tube
    entry: Entry
    branches: tuple[Branch, ...]

    @property
    def clock(self) -> Clock:
        """Abort time of a state of mode 1: its own time."""
        return Clock(0.0, np.zeros(self.far.gens.shape[1]), 0.0)


def reach(question: Question) -> Reach:
    """Reach tubes until the end of the abort window or of the horizon; ``Entry.reason`` explains a failure."""
    centre, gens = question.set()
    system = question.system
    far, near = system.motion(Mode.FAR), system.motion(Mode.NEAR)
    end = question.horizon if question.window is None else question.window[1]
    entry, tube = Entry(0.0, 0.0, ()), None
    for length in (min(_FIRST_TRY, question.horizon + _BEYOND), question.horizon + _BEYOND):
        tube = propagate(far, centre, gens, Fraction(0), FAR_STEP, int(length / FAR_STEP))
        entry = find_entry(tube, centre, gens, question.horizon, system.guard)
        if entry.branches:
            break
    assert tube is not None
    branches = []
    for crossing in entry.branches:
        left = end - crossing.first
        if left <= 0.0:
            continue
        branches.append(Branch(crossing, _near_tubes(near, crossing, left)))
    return Reach(tube.until(min(entry.last, end)), entry, tuple(branches))


def _near_tubes(motion: Motion, crossing: Crossing, length: float) -> tuple[Tube, ...]:
    """Mode 2 for ``length`` minutes at least."""
    ends = [start for start, _ in PHASES[1:]] + [Fraction(max(length, float(PHASES[-1][0])))]
    tubes: list[Tube] = []
    past = 0.0
    for (start, step), end in zip(PHASES, ends, strict=True):
        steps = math.ceil((end - start) / step) + (end == ends[-1])
        tubes.append(propagate(motion, crossing.centre, crossing.gens, start, step, steps, past))
        past = max(past, float(tubes[-1].radius().max()))
    return tuple(tubes)

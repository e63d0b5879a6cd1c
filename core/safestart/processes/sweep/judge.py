"""Certificates of the starts of one scenario."""

from __future__ import annotations

import numpy as np

from safestart.atlas.survey import build
from safestart.closed_form.by_name import ClosedForm, go_of
from safestart.exact.answer import GUARD, Verdict
from safestart.exact.decide import decide
from safestart.exact.question import Question
from safestart.model.scenario import Floats
from safestart.processes.sweep.cases import Cases
from safestart.processes.wire import DT_S

# For at least this many starts an atlas, which costs some hundred answers, gives the same verdicts for less.
WORTH_AN_ATLAS = 400

GO, NO_GO, UNDECIDED, UNASKED = 1, 0, -1, -2
Verdicts = np.ndarray[tuple[int], np.dtype[np.int8]]


def closed_form(name: ClosedForm, cases: Cases) -> Verdicts:
    """GO, or NO_GO for what is not certified."""
    return go_of(name, cases.scenario, cases.points).astype(np.int8)


def exact(cases: Cases, steps: int, most: int) -> Verdicts:
    """Verdict for the first ``most`` starts; the others are UNASKED. Starts that an atlas leaves open are solved
    singly."""
    question = Question(cases.scenario, DT_S, steps)
    out: Verdicts = np.full(len(cases.points), UNASKED, dtype=np.int8)
    out[:most] = UNDECIDED
    points = cases.points[:most]
    if len(points) >= WORTH_AN_ATLAS:
        atlas = build(question, max(float(points[:, 1].max()), cases.scenario.corridor.hold_radius + 1.0))
        lower, upper = atlas.bounds(points)
        out[:most][lower > GUARD] = GO
        out[:most][upper < -GUARD] = NO_GO
    for row in np.nonzero(out[:most] == UNDECIDED)[0]:
        out[row] = of(decide(question, _at_rest(points[row]), verdict_only=True).verdict)
    return out


def of(verdict: Verdict) -> int:
    """The verdict as a small integer."""
    return {Verdict.GO: GO, Verdict.NO_GO: NO_GO, Verdict.UNDECIDED: UNDECIDED}[verdict]


def _at_rest(point: Floats) -> Floats:
    return np.array([point[0], point[1], 0.0, 0.0])

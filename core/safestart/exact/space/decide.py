"""The exact answer in space: bracket of the margin, thrust for GO, multipliers for NO_GO."""

from __future__ import annotations

import numpy as np

from safestart.errors import invalid
from safestart.exact.answer import GUARD, TOLERANCE, Answer
from safestart.exact.decide import answer_of, outside
from safestart.exact.search import Search
from safestart.exact.space.demands.demanded import decide_demanded
from safestart.exact.space.question import SpaceQuestion
from safestart.exact.space.start_box import decide_from_box
from safestart.exact.space.watch import SpaceWatch, space_watch_of
from safestart.exact.synchronize import ended
from safestart.model.scenario import Floats, number


def decide_in_space(
    question: SpaceQuestion, state: Floats, *, tolerance: float = TOLERANCE, verdict_only: bool = False
) -> Answer:
    """Answer for one start ``state`` (6,): LVLH position (m) and velocity (m/s); see :func:`safestart.exact.decide`.

    The answer's ``thrust`` is (N, channels): m/s^2 in LVLH axes for a ball, else points of the unit set (shares of the
    half-widths of a box in its own axes, throttles of thrusters). With demands see
    :mod:`safestart.exact.space.demands.demanded`, with unknowns :mod:`safestart.exact.space.start_box`. Raises
    ``InvalidInput`` for an invalid state.
    """
    state = np.asarray(state, dtype=np.float64)
    if state.shape != (6,) or not np.isfinite(state).all() or float(np.abs(state).max()) > 1e6:
        raise invalid("state", "six finite numbers within 1e6: position and velocity", state)
    number("tolerance", tolerance, 1e-6, 1e3)

    def solve(watch: SpaceWatch) -> tuple[Answer, Floats | None]:
        if question.goal is not None:
            answer = ended(watch, state, tolerance, verdict_only=verdict_only)
            return answer, answer.thrust
        search = Search(watch, state)
        if search.distance_now < -GUARD:
            return outside(search), None
        return answer_of(search, search.narrow(tolerance, verdict_only=verdict_only)), search.thrust

    if question.unknowns:
        return decide_from_box(question, state, np.zeros(6), tolerance=tolerance)
    if question.demands:
        return decide_demanded(question, state, solve)
    return solve(space_watch_of(question))[0]

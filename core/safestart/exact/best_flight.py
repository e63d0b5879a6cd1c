"""The best flight from a start, whatever the verdict: a thrust history with the largest margin."""

from __future__ import annotations

import numpy as np

from safestart.exact.question import Question
from safestart.exact.search import Search
from safestart.exact.watch import watch_of
from safestart.model.scenario import Floats

_GOAL, _ROUNDS = 1e-3, 20


def best_thrust(question: Question, state: Floats) -> Floats:
    """Thrust history (N, d), LVLH m/s^2, whose smallest face distance is within about a millimetre of the best.

    ``state`` (2 d,) is LVLH position (m) and velocity (m/s). If the solver fails, the best so far, or zero thrust.
    """
    search = Search(watch_of(question), np.asarray(state, dtype=np.float64))
    for _ in range(_ROUNDS):
        if search.round() or search.upper - search.lower <= _GOAL or not search.cut(_GOAL):
            break
    still = np.zeros((question.steps, question.dimensions))
    return still if search.thrust is None else search.thrust

"""The exact answer: can this start stay in the corridor at all times of [0, T]? Yes with thrust, no with a proof.

Cutting planes in time. Each round solves the cone program with few rows, watches the proposed flight at all times, and
adds a row where a face comes closer than the program assumed. The program's dual bounds the best margin from above, the
watched flight from below. The loop ends when this bracket is narrower than the tolerance.
"""

from __future__ import annotations

import numpy as np

from safestart.errors import invalid
from safestart.exact.answer import BETWEEN, GUARD, TOLERANCE, Answer, Verdict, concluded
from safestart.exact.question import Question
from safestart.exact.search import Search
from safestart.exact.synchronize import synchronize
from safestart.exact.watch import watch_of
from safestart.model.scenario import Floats, number


def decide(
    question: Question, state: Floats, *, tolerance: float = TOLERANCE, verdict_only: bool = False
) -> Answer:
    """Answer the question for one start ``state`` (2 d,): LVLH position (m) and velocity (m/s).

    The bracket is narrowed to ``tolerance`` metres, or to 2e-7 m if it contains 0, as far as samples of the flight can
    show that; then the best flight is sampled four times as often. With ``verdict_only`` the
    loop ends as soon as the verdict is proved: same verdict, wider bracket. Raises ``InvalidInput`` for a state of
    another shape or not finite. A failure of the solver is UNDECIDED with its reason, never a GO.
    """
    state = np.asarray(state, dtype=np.float64)
    if state.shape != (2 * question.dimensions,):
        raise invalid("state", f"shape ({2 * question.dimensions},): position and velocity", state.shape)
    if not all(abs(entry) <= 1e6 for entry in state.tolist()):
        raise invalid("state", "finite numbers within 1e6", state)
    number("tolerance", tolerance, 1e-6, 1e3)
    if question.goal is not None:
        return synchronize(watch_of(question), state, tolerance, verdict_only=verdict_only)
    watch = watch_of(question)
    if question.plain:
        # Imported with the first question, because Numba takes a second to load.
        from safestart.exact.kernels.stay import stay

        answer = stay(watch, state, tolerance, verdict_only=verdict_only)
        if answer is not None:
            return answer
    search = Search(watch, state)
    if search.distance_now < -GUARD:
        return outside(search)
    reason = search.narrow(tolerance, verdict_only=verdict_only)
    if reason == BETWEEN and search.lower <= GUARD and search.upper >= -GUARD:
        # What the samples miss is 1e-7 to 1e-6 m, which may be all that is open.
        search.look_closer(watch.closer())
    return answer_of(search, reason)


def outside(search: Search) -> Answer:
    """NO_GO at once for a start outside the corridor: thrust cannot change the distance at t = 0."""
    question = search.watch.question
    still = np.zeros((question.steps, question.channels))
    worst = search.distance_now
    lower = min(worst, search.watch.minima(search.state, still).lowest)
    return Answer(Verdict.NO_GO, worst, lower, worst, None, (search.now,), 0)


def answer_of(search: Search, reason: str) -> Answer:
    """Verdict, bracket and evidence of a search that has ended, for ``reason`` where it is open."""
    proof = search.evidence.multipliers(search.watch.names) if search.evidence else ()
    return concluded((search.lower, search.upper), search.thrust, proof, search.rounds, reason)

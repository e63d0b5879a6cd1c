"""The exact answer: may this start stay in the corridor at all times of [0, T]? Yes with thrust, no with a proof.

Cutting planes in time. The conic program is solved with few rows; the flight it proposes is watched at all times; where
a face comes closer than the program knew, a row is added. The program's dual bounds the best margin from above, the
watched flight from below: each round ends with a bracket, the loop with one narrower than the tolerance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from safestart.certificates.question import Question
from safestart.certificates.search import Search
from safestart.certificates.watch import watch_of
from safestart.errors import invalid
from safestart.scenario import Floats, number

TOLERANCE = 1e-4
# Floats carry the distances to about 1e-12 m; a verdict keeps three orders of magnitude away from that.
GUARD = 1e-9
_FINEST = 2e-7
_ROUNDS = 40


class Verdict(StrEnum):
    """GO: a thrust history stays. NO_GO: none does. UNDECIDED: the bracket holds 0, or the solver failed."""

    GO = "GO"
    NO_GO = "NO_GO"
    UNDECIDED = "UNDECIDED"


@dataclass(frozen=True, slots=True)
class Multiplier:
    """Weight of one face's distance at one time (s) in the proof of a NO_GO."""

    time: float
    face: str
    value: float


@dataclass(frozen=True, slots=True)
class Answer:
    """Verdict and bracket of the signed margin m in metres (all face distances >= m at all times, at best).

    ``lower`` is what the thrust history ``thrust`` (N, d), LVLH m/s^2, keeps at all times; ``upper`` what the
    ``multipliers`` prove that no history exceeds. ``margin_m`` is the end of the bracket the verdict rests on:
    ``lower`` for GO, ``upper`` for NO_GO, their middle when UNDECIDED (NaN without a bracket). A GO carries no
    multipliers, a NO_GO no thrust. ``reason`` says why an answer is UNDECIDED, else it is empty.
    """

    verdict: Verdict
    margin_m: float
    lower: float
    upper: float
    thrust: Floats | None
    multipliers: tuple[Multiplier, ...]
    iterations: int
    reason: str = ""

    @property
    def gap(self) -> float:
        """Width of the bracket in metres."""
        return self.upper - self.lower


def decide(
    question: Question, state: Floats, *, tolerance: float = TOLERANCE, verdict_only: bool = False
) -> Answer:
    """Answer the question `stay` for one start ``state`` (2 d,): LVLH position (m) and velocity (m/s).

    The bracket is narrowed to ``tolerance`` metres, further where 0 lies in it (to 2e-7 m). With ``verdict_only`` the
    loop ends as soon as the verdict is proved: same verdict, wider bracket. Raises ``InvalidInput`` for a state of
    another shape or not finite. A failure of the solver is UNDECIDED with its reason, never a GO.
    """
    state = np.asarray(state, dtype=np.float64)
    if state.shape != (2 * question.dimensions,):
        raise invalid("state", f"shape ({2 * question.dimensions},): position and velocity", state.shape)
    if not np.isfinite(state).all() or float(np.abs(state).max()) > 1e6:
        raise invalid("state", "finite numbers within 1e6", state)
    number("tolerance", tolerance, 1e-6, 1e3)
    search = Search(watch_of(question), state)
    if search.distance_now < -GUARD:
        return _outside(search)
    reason = "0 lies between the bounds"
    for _ in range(_ROUNDS):
        failed = search.round()
        if failed:
            reason = failed
            break
        decided = search.lower > GUARD or search.upper < -GUARD
        goal = tolerance if decided else _FINEST
        if search.upper - search.lower <= goal or (decided and verdict_only) or not search.cut(goal):
            break
    return _answer(search, reason)


def _outside(search: Search) -> Answer:
    """NO_GO at once for a start outside the corridor: the distance at t = 0 is what it is, whatever the thrust."""
    question = search.watch.question
    still = np.zeros((question.steps, question.dimensions))
    worst = search.distance_now
    lower = min(worst, search.watch.minima(search.state, still).lowest)
    proof = (Multiplier(0.0, search.watch.names[search.face_now], 1.0),)
    return Answer(Verdict.NO_GO, worst, lower, worst, None, proof, 0)


def _answer(search: Search, reason: str) -> Answer:
    lower, upper, rounds = search.lower, search.upper, search.rounds
    if lower > GUARD:
        return Answer(Verdict.GO, lower, lower, upper, search.thrust, (), rounds)
    proof = tuple(
        Multiplier(float(time), search.watch.names[face], float(value)) for time, face, value in search.proof
    )
    if upper < -GUARD:
        return Answer(Verdict.NO_GO, upper, lower, upper, None, proof, rounds)
    finite = math.isfinite(lower) and math.isfinite(upper)
    middle = 0.5 * (lower + upper) if finite else math.nan
    return Answer(Verdict.UNDECIDED, middle, lower, upper, search.thrust, proof, rounds, reason)

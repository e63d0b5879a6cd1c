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

from safestart.certificates.conic import solve
from safestart.certificates.question import Question
from safestart.certificates.watch import Cuts, Watch, watch_of
from safestart.errors import invalid
from safestart.scenario import Floats, number

TOLERANCE = 1e-4
# Floats carry the distances to about 1e-12 m; a verdict keeps three orders of magnitude away from that.
GUARD = 1e-9
_FINEST = 2e-7
_ROUNDS = 40
_FIRST_TIMES = 7


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
    watch = watch_of(question)
    search = _Search(watch, state)
    outside = search.outside()
    if outside is not None:
        return outside
    goal, reason = tolerance, "the tolerance lies between the bounds and 0"
    for _ in range(_ROUNDS):
        failed = search.round()
        if failed:
            reason = failed
            break
        decided = search.lower > GUARD or search.upper < -GUARD
        if decided and (verdict_only or search.upper - search.lower <= tolerance):
            break
        goal = tolerance if decided else _FINEST
        if search.upper - search.lower <= goal or not search.cut(goal):
            break
    return search.answer(reason)


class _Search:
    """The state of one answer's loop: rows so far, best flight, best proof."""

    def __init__(self, watch: Watch, state: Floats) -> None:
        self.watch, self.state = watch, state
        self.lower, self.upper = -math.inf, math.inf
        self.thrust: Floats | None = None
        self.iterations = 0
        faces = len(watch.names)
        self.start = watch.offsets - watch.normals @ state[: watch.question.dimensions]
        times = np.repeat(np.linspace(0.0, watch.question.horizon, _FIRST_TIMES)[1:], faces)
        first = np.full(1, int(np.argmin(self.start)), dtype=np.int64)
        every = np.concatenate([first, np.tile(np.arange(faces), _FIRST_TIMES - 1)])
        self._keep(watch.cuts(np.concatenate([[0.0], times]), every))

    def _keep(self, cuts: Cuts) -> None:
        constant = cuts.offset + cuts.start @ self.state
        if self.iterations == 0:
            self.times, self.faces, self.constant, self.rows = cuts.times, cuts.faces, constant, cuts.thrust
            return
        self.times = np.concatenate([self.times, cuts.times])
        self.faces = np.concatenate([self.faces, cuts.faces])
        self.constant = np.concatenate([self.constant, constant])
        self.rows = np.concatenate([self.rows, cuts.thrust])

    def outside(self) -> Answer | None:
        """NO_GO at once for a start outside the corridor: the distance at t = 0 is what it is."""
        face = int(np.argmin(self.start))
        worst = float(self.start[face])
        if worst >= -GUARD:
            return None
        still = np.zeros((self.watch.question.steps, self.watch.question.dimensions))
        lower = min(worst, self.watch.minima(self.state, still).lowest)
        proof = (Multiplier(0.0, self.watch.names[face], 1.0),)
        return Answer(Verdict.NO_GO, worst, lower, worst, None, proof, 0)

    def round(self) -> str:
        """Solve with the rows so far and watch the flight; the reason if the solver failed, else empty."""
        question = self.watch.question
        self.iterations += 1
        found = solve(
            self.constant, self.rows, question.scenario.chaser.max_acceleration, question.dimensions
        )
        if found.thrust is None or found.weights is None:
            return f"the solver stopped with {found.status} in round {self.iterations}"
        if found.bound < self.upper:
            self.upper = found.bound
            kept = np.nonzero(found.weights > 0.0)[0]
            self.weights = found.weights[kept], self.times[kept], self.faces[kept]
        self.found = self.watch.minima(self.state, found.thrust)
        if self.found.lowest > self.lower:
            self.lower, self.thrust = self.found.lowest, found.thrust
        return ""

    def cut(self, goal: float) -> bool:
        """Add the local minima that lie below what the program promised; False when there is none."""
        minima = self.found
        low = minima.values < self.upper - 0.25 * goal
        times, faces = minima.times[low], minima.faces[low]
        if not len(times):
            return False
        self._keep(self.watch.cuts(times, faces))
        return True

    def answer(self, reason: str) -> Answer:
        """The answer with what the loop has proved."""
        lower, upper = self.lower, self.upper
        if lower > GUARD:
            return Answer(Verdict.GO, lower, lower, upper, self.thrust, (), self.iterations)
        proof: tuple[Multiplier, ...] = ()
        if math.isfinite(upper):
            proof = tuple(
                Multiplier(float(time), self.watch.names[face], float(value))
                for value, time, face in zip(*self.weights, strict=True)
            )
        if upper < -GUARD:
            return Answer(Verdict.NO_GO, upper, lower, upper, None, proof, self.iterations)
        finite = math.isfinite(lower) and math.isfinite(upper)
        middle = 0.5 * (lower + upper) if finite else math.nan
        return Answer(Verdict.UNDECIDED, middle, lower, upper, self.thrust, proof, self.iterations, reason)

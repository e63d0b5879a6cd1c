"""Verdicts at instants, and the changes between them closed in on."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.constraints.thrust_limit import ThrustLimit
from safestart.errors import InvalidInput
from safestart.exact.answer import GUARD, Answer, Verdict
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.model_error import model_error
from safestart.exact.space.prove import proof_in_space
from safestart.exact.space.question import Face, SpaceQuestion
from safestart.exact.space.start_box import decide_from_box
from safestart.interchange.epochs import SECOND, Nanoseconds
from safestart.interchange.relative import Relative
from safestart.model.scenario import Floats
from safestart.timeline.encounter import Encounter

DT_S = 2.0
FURTHEST_M = 1e5
"""A chaser further away, or faster than this in m/s, is asked about by no proof."""


@dataclass(frozen=True, slots=True)
class Instant:
    """The verdict at one TAI ``epoch``, ns; ``margin`` bounds the largest margin, m: from below for GO, else above.

    ``why`` is empty where the verdict is proved. The linear model itself may be off by about ``error`` m.
    """

    epoch: int
    verdict: str
    margin: float
    why: str = ""
    error: float = 0.0


@dataclass(frozen=True)
class Corridor:
    """Faces of one corridor under a name."""

    name: str
    faces: tuple[Face, ...]

    def lengths(self) -> Floats:
        """Lengths (F,) of the normals."""
        return np.array([math.hypot(*face.normal) for face in self.faces])


@dataclass(frozen=True)
class Judge:
    """Asks, at any instants, whether a chaser that leaves its course then can stay for the horizon.

    Where the encounter has boxes of starts, one thrust history must do for the whole box of the instant.
    """

    encounter: Encounter
    corridor: Corridor
    thrust: ThrustLimit

    @property
    def steps(self) -> int:
        """Control intervals of a question."""
        return round(self.encounter.horizon / DT_S)

    def instants(self, epochs: Nanoseconds) -> list[Instant]:
        """Verdicts at TAI ``epochs`` (K,)."""
        seen = self.encounter.seen(epochs)
        covered = self.encounter.covered(epochs)
        far = ~(np.abs(seen.states).max(axis=1) <= FURTHEST_M)
        half = self._half(epochs)
        spread = np.ones(len(epochs), dtype=bool) if half is None else np.isfinite(half).all(axis=1)
        plain = seen.known & covered & ~far & spread
        room = np.full(len(epochs), np.nan)
        if plain.any() and half is None:
            room[plain] = self._room(seen.where(plain))
        out = []
        for k, epoch in enumerate(epochs.tolist()):
            if not plain[k]:
                why = _unknown(bool(seen.known[k]), bool(covered[k]), bool(far[k]))
                out.append(Instant(epoch, Verdict.UNDECIDED.value, math.nan, why))
            elif room[k] < -GUARD:
                # Outside now: no thrust changes that. The proof is one weight on the face.
                out.append(Instant(epoch, Verdict.NO_GO.value, float(room[k])))
            else:
                out.append(self._asked(seen, k, None if half is None else half[k]))
        return out

    def _half(self, epochs: Nanoseconds) -> Floats | None:
        """Half-widths (K, 6) of the boxes of starts; None where the state is taken as known."""
        boxes = self.encounter.boxes
        return None if boxes is None else boxes.half_widths(epochs)

    def _room(self, seen: Relative) -> Floats:
        """Least distance (K,) to the faces now, m."""
        own = np.array([face.normal for face in self.corridor.faces])
        in_body = np.array([face.frame == "body" for face in self.corridor.faces])
        position = seen.states[:, :3]
        body = np.einsum("kij,kj->ki", self.encounter.turns(seen), position)
        along = np.where(in_body, body @ own.T, position @ own.T)
        offsets = np.array([face.offset for face in self.corridor.faces])
        out: Floats = ((offsets - along) / self.corridor.lengths()).min(axis=1)
        return out

    def _asked(self, seen: Relative, k: int, half: Floats | None) -> Instant:
        epoch = int(seen.epochs[k])
        try:
            question = self._question(seen, k)
            answer = _answer(question, seen.states[k], half)
        except InvalidInput as error:
            return Instant(epoch, Verdict.UNDECIDED.value, math.nan, error.detail)
        off = model_error(question, seen.states[k])
        return Instant(epoch, answer.verdict.value, _bound(answer), answer.reason, off)

    def _question(self, seen: Relative, k: int) -> SpaceQuestion:
        orbit = self.encounter.orbit(seen, k)
        attitude = self.encounter.attitude_from(seen, k, orbit)
        return SpaceQuestion(orbit, attitude, self.corridor.faces, self.thrust, DT_S, self.steps)

    def proof(self, epoch: int) -> dict[str, Any] | None:
        """The proof document of the verdict at an epoch; None where there is nothing to prove."""
        seen = self.encounter.seen(np.array([epoch]))
        boxes = self._half(seen.epochs)
        half = None if boxes is None else boxes[0]
        if half is not None and not np.isfinite(half).all():
            return None
        if not (seen.known[0] and self.encounter.covered(seen.epochs)[0]):
            return None
        if not float(np.abs(seen.states).max()) <= FURTHEST_M:
            return None
        try:
            question = self._question(seen, 0)
            answer = _answer(question, seen.states[0], half)
        except InvalidInput:
            return None
        if answer.verdict is Verdict.UNDECIDED:
            return None
        return proof_in_space(question, seen.states[0], answer, half)

    def closed_in(self, left: Instant, right: Instant, bracket: float) -> list[Instant]:
        """Instants between two of different verdicts, until neighbours that differ are ``bracket`` s apart."""
        if left.verdict == right.verdict or right.epoch - left.epoch <= bracket * SECOND:
            return []
        (middle,) = self.instants(np.array([(left.epoch + right.epoch) // 2]))
        return [*self.closed_in(left, middle, bracket), middle, *self.closed_in(middle, right, bracket)]


def _answer(question: SpaceQuestion, state: Floats, half: Floats | None) -> Answer:
    if half is None:
        return decide_in_space(question, state, verdict_only=True)
    return decide_from_box(question, state, half)


def _unknown(known: bool, covered: bool, far: bool) -> str:
    if not known:
        return "the files hold no states here"
    if not covered:
        return "the attitude does not go on to the end of the horizon"
    return "the chaser is too far away" if far else "the files hold no covariance near here"


def _bound(answer: Answer) -> float:
    if answer.verdict is Verdict.UNDECIDED:
        return answer.margin_m
    return answer.lower if answer.verdict is Verdict.GO else answer.upper


def joined(instants: Sequence[Instant]) -> list[list[Instant]]:
    """Instants in runs of one verdict and one reason."""
    runs: list[list[Instant]] = []
    for one in instants:
        if runs and (runs[-1][-1].verdict, runs[-1][-1].why) == (one.verdict, one.why):
            runs[-1].append(one)
        else:
            runs.append([one])
    return runs

"""Answers to the exact questions: verdict, bracket, and the evidence either way."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from safestart.exact.norm_rows import Blocks
from safestart.exact.watch import Ints
from safestart.model.scenario import Floats

TOLERANCE = 1e-4
# Floats give the distances to about 1e-12 m; a verdict needs a bound three orders of magnitude larger.
GUARD = 1e-9
BETWEEN = "0 lies between the bounds"
"""Why an answer is UNDECIDED, as a rule."""


class Verdict(StrEnum):
    """GO: a thrust history stays. NO_GO: none stays. UNDECIDED: the bracket holds 0, or the solver failed."""

    GO = "GO"
    NO_GO = "NO_GO"
    UNDECIDED = "UNDECIDED"


@dataclass(frozen=True, slots=True)
class Multiplier:
    """Weight of one face's distance at one time (s) in the proof of a NO_GO.

    For a norm limit (``speed``, ``hold``, ``rest``) ``pull`` is the vector p, |p| <= value, of
    :mod:`safestart.exact.limits`; ``hold`` and ``rest`` apply at the end, whatever their time.
    """

    time: float
    face: str
    value: float
    pull: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Part:
    """Multipliers that refute every end T = k dt with k from ``first`` to ``last``; times after T do not count."""

    first: int
    last: int
    multipliers: tuple[Multiplier, ...]


@dataclass(frozen=True, slots=True)
class Arrival:
    """After the end of `synchronize`: a ``stop`` of so many seconds against the body frame, then standing for ever, at
    least ``margin`` m from every face (:mod:`safestart.exact.arrival`)."""

    stop: float
    margin: float


@dataclass(frozen=True, slots=True)
class Held:
    """After the end of `synchronize`: a feedback that keeps the chaser for ever (:mod:`safestart.exact.hold_after`).

    The thrust is u_ref + ``gain`` (2, 4) e, held over the question's steps, e the error (LVLH, m and m/s) against a
    reference that is at ``point`` (2,), m, of the body frame at every step. All e with e' ``cost`` e <= ``level``
    stay ``margin`` m from every face; that of the end is one.
    """

    point: Floats
    gain: Floats
    cost: Floats
    level: float
    margin: float


@dataclass(frozen=True, slots=True)
class Answer:
    """Verdict and bracket of the signed margin m in metres (all face distances >= m at all times, at best).

    The thrust history ``thrust`` (N, d), LVLH m/s^2, keeps the margin ``lower`` at all times; the ``multipliers`` prove
    that no history exceeds ``upper``. ``margin_m`` is the end of the bracket behind the verdict: ``lower`` for GO,
    ``upper`` for NO_GO, their middle when UNDECIDED (NaN without a bracket). A GO carries no multipliers, a NO_GO no
    thrust. ``reason`` says why an answer is UNDECIDED, else it is empty.

    For `synchronize` m is the best over T, ``thrust`` ends at the T it was found for, and ``parts`` stand for
    ``multipliers``. The loop ends with the verdict, so the bracket may be wide. ``arrival`` says how a GO goes on for
    ever; None where that is not proved. ``held`` says the same by a feedback, where that was asked. ``restriction``
    names the convex parts of the demands by which a GO was found.
    """

    verdict: Verdict
    margin_m: float
    lower: float
    upper: float
    thrust: Floats | None
    multipliers: tuple[Multiplier, ...]
    iterations: int
    reason: str = ""
    parts: tuple[Part, ...] = ()
    arrival: Arrival | None = None
    held: Held | None = None
    restriction: tuple[str, ...] = ()

    @property
    def gap(self) -> float:
        """Width of the bracket in metres."""
        return self.upper - self.lower

    @property
    def proved_m(self) -> float:
        """``margin_m`` of a GO or a NO_GO, which is proved; NaN when UNDECIDED.

        What we tell others: the middle of a bracket that holds 0 is no bound, and may even be positive.
        """
        return math.nan if self.verdict is Verdict.UNDECIDED else self.margin_m


@dataclass(frozen=True, slots=True)
class Evidence:
    """Weighted rows that bound a margin: faces at times (J,), then ``blocks``; ``constant`` and ``rows`` stack both.

    ``weights`` has one entry for each stacked row; those on rows that hold m (faces, first rows of blocks) sum to 1.
    """

    times: Floats
    faces: Ints
    blocks: Blocks
    constant: Floats
    rows: Floats
    weights: Floats

    def until(self, latest: float) -> Evidence:
        """Move every time after ``latest`` (s) to it: rounding may have put one there."""
        blocks = replace(self.blocks, times=np.minimum(self.blocks.times, latest))
        return replace(self, times=np.minimum(self.times, latest), blocks=blocks)

    def multipliers(self, names: tuple[str, ...]) -> tuple[Multiplier, ...]:
        """The weights above 0, by name; ``names`` are the faces'."""
        count = len(self.faces)
        plain = self.weights[:count]
        out = face_multipliers(self.times, self.faces, plain, names)
        if self.blocks.names:
            vectors = self.weights[count:].reshape(len(self.blocks.names), -1).tolist()
            for name, time, (value, *z) in zip(
                self.blocks.names, self.blocks.times.tolist(), vectors, strict=True
            ):
                if value > 0.0:
                    # The cone's dual adds z . y, a multiplier takes p . y away.
                    out.append(Multiplier(time, name, value, tuple(-e for e in z)))
        return tuple(out)


def face_multipliers(times: Floats, faces: Ints, weights: Floats, names: tuple[str, ...]) -> list[Multiplier]:
    """The weights (J,) above 0 of faces at times, by name."""
    rows = zip(times.tolist(), faces.tolist(), weights.tolist(), strict=True)
    return [Multiplier(time, names[face], value) for time, face, value in rows if value > 0.0]


def concluded(
    bracket: tuple[float, float],
    thrust: Floats | None,
    proof: tuple[Multiplier, ...],
    rounds: int,
    reason: str,
) -> Answer:
    """The answer of a search that ended with this bracket, ``reason`` where it is open."""
    lower, upper = bracket
    if lower > GUARD:
        return Answer(Verdict.GO, lower, lower, upper, thrust, (), rounds)
    if upper < -GUARD:
        return Answer(Verdict.NO_GO, upper, lower, upper, None, proof, rounds)
    finite = math.isfinite(lower) and math.isfinite(upper)
    middle = 0.5 * (lower + upper) if finite else math.nan
    return Answer(Verdict.UNDECIDED, middle, lower, upper, thrust, proof, rounds, reason)

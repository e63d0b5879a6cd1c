"""Answers for families: verdict, evidence for all members, or two members that differ."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from safestart.exact.answer import Answer, Multiplier, Verdict
from safestart.exact.question import Question
from safestart.families.members import Interval
from safestart.model.scenario import Floats

TOLERANCE = 1e-3
Witness = Literal["common", "per_corner"]


@dataclass(frozen=True, slots=True)
class History:
    """A thrust history (N, d), m/s^2, for the start at ``corner`` (2 d,), signs of the box's half-widths; 0: all."""

    corner: tuple[int, ...]
    thrust: Floats


@dataclass(frozen=True, slots=True)
class Piece:
    """Multipliers for all members with a tumble rate in ``rates`` (rad/s): no margin exceeds ``upper`` (m)."""

    rates: Interval
    multipliers: tuple[Multiplier, ...]
    upper: float


@dataclass(frozen=True, slots=True)
class Example:
    """One member with its answer: the question, a start of the box (2 d,) and what is proved for it."""

    question: Question
    start: Floats
    answer: Answer


@dataclass(frozen=True, slots=True)
class ForAll:
    """Verdict for a family; ``margin_m`` is the proved bound behind it.

    GO: ``histories`` keep ``margin_m`` > 0 to every face for every member, as ``witness`` says; proved at the
    ``rates`` and ``motions`` (rad/s), with bounds between. NO_GO: the ``pieces`` show that no member's history keeps
    more than ``margin_m`` < 0. UNDECIDED: NaN, with a ``reason``; if the verdict differs between members, ``examples``
    holds one GO and one NO_GO member.

    ``upper`` bounds the margin that a witness of the requested kind can keep (inf if none was sought).
    """

    verdict: Verdict
    margin_m: float
    upper: float
    witness: Witness
    histories: tuple[History, ...] = ()
    rates: tuple[float, ...] = ()
    motions: tuple[float, ...] = ()
    pieces: tuple[Piece, ...] = ()
    examples: tuple[Example, ...] = ()
    reason: str = ""

"""Burns with a duration, as sets of states at their planned time, in ball arithmetic.

A burn that begins t late and lasts for u gives H(t + u) - H(t), H the integral of f(s) = Phi(0, s) (0, a); over a piece
of times it lies within its value and its tangents in the middle and a box for the second derivatives H'' and H'''.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from flint import arb, arb_mat, fmpq

from safestart.proofs.abort.reached import Reached, axes, column, generator, held, shell, transition
from safestart.proofs.abort.statement import Asked, Event

LONG = ("made", "cut", "stuck")
"""Kinds after which the chaser drifts for the whole horizon, however long the burn lasts."""


Piece = tuple[fmpq, fmpq]


def times(asked: Asked, event: Event) -> tuple[Piece, Piece]:
    """How late the burn of an event begins, and how long it lasts; one that is stuck on goes on for the event's piece
    after its whole time."""
    if event.kind != "stuck":
        return (event.first, event.last), event.on
    whole = asked.durations[event.burn]
    return (fmpq(0), fmpq(0)), (whole + event.first, whole + event.last)


def window(asked: Asked, event: Event) -> tuple[fmpq, fmpq]:
    """From when to when the chaser may drift from the set of an event of a burn with a duration, s after its planned
    time. A burn that is late, weak or misdirected and still burns is covered only for as long as it may."""
    late, on = times(asked, event)
    begin, end = late[0] + on[0], late[1] + on[1]
    whole = asked.durations[event.burn]
    if event.kind not in LONG and event.on != (whole, whole):
        return begin, end
    until = asked.horizon + end
    if event.kind == "made" and event.burn + 1 < len(asked.times):
        until = max(until, asked.times[event.burn + 1] - asked.times[event.burn] + asked.late)
    return begin, until


@dataclass(frozen=True, slots=True)
class Rates:
    """Greatest sizes of the first two derivatives of f, in each of the six, |a| = 1."""

    first: list[arb]
    second: list[arb]


class Pushed(Protocol):
    """Pushes at other times as states at the planned time of the burn; times in s after it."""

    def at(self, time: fmpq) -> arb_mat:
        """f (6, 3) per unit of a."""

    def total(self, time: fmpq) -> arb_mat:
        """Its integral (6, 3) from 0 on."""

    def rates(self, longest: fmpq) -> Rates:
        """Bounds from 0 to ``longest``."""


class CwhPushed:
    """In CWH motion."""

    def __init__(self, n: fmpq) -> None:
        self.n = arb(n)

    def at(self, time: fmpq) -> arb_mat:
        """Phi(-time) (0, I)."""
        return _pushed(self.n, arb(time))

    def total(self, time: fmpq) -> arb_mat:
        """Its integral."""
        return -1 * held(self.n, -arb(time))

    def rates(self, longest: fmpq) -> Rates:
        """By balls of time."""
        return _rates(self.n, arb(longest) / 2 + arb(0, 1) * (arb(longest) / 2))


def burning(asked: Asked, before: Reached, event: Event, pushed: Pushed) -> Reached:
    """The set before burn ``event.burn``, and all that the burn adds in this event."""
    burn = event.burn
    share, angle = arb(asked.share), arb(asked.angle)
    wide = arb.min(angle + arb(asked.misdirected), arb.pi()) if event.kind == "misdirected" else angle
    least = arb(0) if event.kind == "partial" else 1 - share
    middle, half, across = shell(least, 1 + share, wide)
    along, one, two, impulse = axes([arb(e) for e in asked.impulses[burn]])
    size = impulse / arb(asked.durations[burn])
    delay, lasts = times(asked, event)
    late, on = (delay[0] + delay[1]) / 2, (lasts[0] + lasts[1]) / 2
    late_by, on_by = arb((delay[1] - delay[0]) / 2), arb((lasts[1] - lasts[0]) / 2)
    gives, given = (pushed.total(late + time) - pushed.total(late) for time in (on, lasts[1]))
    # Across the burn: u/u_2 of what it gives in its longest time u_2, but for the chord's error u_2^2/8 |H''|.
    blocks = [
        [gives * column([half * size * e for e in along])],
        [given * column([across * size * e for e in unit]) for unit in (one, two)],
    ]
    end, begin = pushed.at(late + on), pushed.at(late)
    most = column([(1 + share) * size * e for e in along])
    blocks += [[late_by * ((end - begin) * most)], [on_by * (end * most)]]
    state = Reached(
        before.centre + gives * column([middle * size * e for e in along]), [*before.blocks, *blocks]
    )
    rates = pushed.rates(delay[1] + lasts[1])
    _, own, aside = shell(1 - share, 1 + share, angle)
    unsteady = size * (own * own + aside * aside).sqrt()
    reach, top = arb(lasts[1]), (1 + share) * size
    chord = reach**2 / 8 if lasts[0] < lasts[1] else arb(0)
    return state.grown(
        [
            top
            * (late_by**2 / 2 * reach * rates.second[k] + (late_by * on_by + on_by**2 / 2) * rates.first[k])
            + size * across * (late_by * reach + chord) * rates.first[k]
            + unsteady * reach**2 / 2 * rates.first[k]
            for k in range(6)
        ]
    )


def _pushed(n: arb, time: arb) -> arb_mat:
    """Phi(-time) (0, I), (6, 3)."""
    return arb_mat([row[3:] for row in transition(n, -time).tolist()])


def _rates(n: arb, span: arb) -> Rates:
    a = generator(n)
    slope = a * _pushed(n, span)
    return Rates(_sizes(slope), _sizes(a * slope))


def _sizes(matrix: arb_mat) -> list[arb]:
    """Norms of the rows, from above."""
    return [sum((arb(e.abs_upper()) ** 2 for e in row), arb(0)).sqrt() for row in matrix.tolist()]

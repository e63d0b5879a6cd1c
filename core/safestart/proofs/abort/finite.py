"""Burns with a duration, as sets of states at their planned time, in ball arithmetic.

A burn that begins t late and lasts for u gives H(t + u) - H(t), H(s) = int_0^s Phi(-r) (0, a) dr; over a piece of times
it lies within its value and its tangents in the middle and a box for the second derivatives H'' and H'''.
"""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb, arb_mat, fmpq

from safestart.proofs.abort.reached import Reached, axes, column, generator, held, shell, transition
from safestart.proofs.abort.statement import Asked, Event

FULL_THRUST = ("made", "cut", "late", "stuck")
LONG = ("made", "cut", "stuck")
"""Kinds after which the chaser drifts for the whole horizon, however long the burn lasts."""


def window(asked: Asked, event: Event) -> tuple[fmpq, fmpq]:
    """From when to when the chaser may drift from the set of an event of a burn with a duration, s after its planned
    time. A burn that is late, weak or misdirected and still burns is covered only for as long as it may."""
    begin, end = event.first + event.on[0], event.last + event.on[1]
    whole = asked.durations[event.burn]
    if event.kind not in LONG and event.on != (whole, whole):
        return begin, end
    until = asked.horizon + end
    if event.kind == "made" and event.burn + 1 < len(asked.times):
        until = max(until, asked.times[event.burn + 1] - asked.times[event.burn] + asked.late)
    return begin, until


@dataclass(frozen=True, slots=True)
class _Rates:
    """Greatest sizes of Phi(-s) (0, e) and of its first two derivatives, in each of the six, |e| = 1, s in a ball."""

    value: list[arb]
    first: list[arb]
    second: list[arb]


def burning(asked: Asked, before: Reached, event: Event) -> Reached:
    """The set before burn ``event.burn``, and all that the burn adds in this event."""
    n, burn = arb(asked.n), event.burn
    share, angle = arb(asked.share), arb(asked.angle)
    wide = arb.min(angle + arb(asked.misdirected), arb.pi()) if event.kind == "misdirected" else angle
    least = arb(0) if event.kind == "partial" else 1 - share
    middle, half, across = shell(least, 1 + share, wide)
    along, one, two, impulse = axes([arb(e) for e in asked.impulses[burn]])
    size = impulse / arb(asked.durations[burn])
    late, late_by = _piece(event.first, event.last)
    on, on_by = _piece(*event.on)
    gives = held(n, -late) - held(n, -late - on)
    blocks = [
        [gives * column([half * size * e for e in along])],
        [gives * column([across * size * e for e in unit]) for unit in (one, two)],
    ]
    end, begin = _pushed(n, late + on), _pushed(n, late)
    most = column([(1 + share) * size * e for e in along])
    blocks += [[late_by * ((end - begin) * most)], [on_by * (end * most)]]
    state = Reached(
        before.centre + gives * column([middle * size * e for e in along]), [*before.blocks, *blocks]
    )
    longest = arb(event.last + event.on[1])
    rates = _rates(n, longest / 2 + arb(0, 1) * (longest / 2))
    _, own, aside = shell(1 - share, 1 + share, angle)
    unsteady = size * (own * own + aside * aside).sqrt()
    reach, top = arb(event.on[1]), (1 + share) * size
    return state.grown(
        [
            top
            * (late_by**2 / 2 * reach * rates.second[k] + (late_by * on_by + on_by**2 / 2) * rates.first[k])
            + size * across * (late_by * reach * rates.first[k] + on_by * rates.value[k])
            + unsteady * reach**2 / 2 * rates.first[k]
            for k in range(6)
        ]
    )


def _piece(first: fmpq, last: fmpq) -> tuple[arb, arb]:
    return arb((first + last) / 2), arb((last - first) / 2)


def _pushed(n: arb, time: arb) -> arb_mat:
    """Phi(-time) (0, I), (6, 3)."""
    return arb_mat([row[3:] for row in transition(n, -time).tolist()])


def _rates(n: arb, span: arb) -> _Rates:
    a, value = generator(n), _pushed(n, span)
    slope = a * value
    first = _sizes(slope)
    # A position begins at 0 and grows no faster than its greatest rate.
    longest = arb(span.upper())
    reached = [longest * rate for rate in first[:3]] + _sizes(value)[3:]
    return _Rates(reached, first, _sizes(a * slope))


def _sizes(matrix: arb_mat) -> list[arb]:
    """Norms of the rows, from above."""
    return [sum((arb(e.abs_upper()) ** 2 for e in row), arb(0)).sqrt() for row in matrix.tolist()]

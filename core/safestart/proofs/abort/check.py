"""Every case of a missed-burn proof, at all times: the cells cover the drift, and each keeps the claimed distance.

On a cell [a, b] with direction d, q(t) = Phi_p(t)' d and f = q . centre - sum |M_k' q|, which is concave in q, less
d . z and sum |Z_k' d| of the zone's centre and blocks:

    |d| distance >= min(f(a), f(b)) - (b - a)^2/8 (sup |q'' . centre| + sum sup |M_k' q''|).
"""

from __future__ import annotations

from itertools import pairwise

from flint import arb, arb_mat, fmpq

from safestart.proofs.abort.complete import Complete
from safestart.proofs.abort.earth.sets import EarthChecker
from safestart.proofs.abort.reached import Reached, transition
from safestart.proofs.abort.sets import Sets
from safestart.proofs.abort.statement import Asked, Event, Zone, read
from safestart.proofs.abort.strays import strays
from safestart.proofs.strict import ProofRejected
from safestart.runtime.precision import precise

_BITS = 128


def check(document: object) -> tuple[Asked, int]:
    """Check a document; the statement and the number of cells, or ``ProofRejected``."""
    asked = read(document)
    with precise(_BITS):
        return asked, (EarthChecker if asked.earth is not None else Checker)(asked).check()


class Checker(Complete):
    """One statement under check, about a circular orbit."""

    def __init__(self, asked: Asked) -> None:
        super().__init__(asked)
        self.n, self.sets = arb(asked.n), Sets(asked)
        self.rows: dict[fmpq, arb_mat] = {}
        # q'' = P cos n t + Q sin n t, from Phi_p'' = P' cos n t + Q' sin n t.
        n = self.n
        p, q = arb_mat(3, 6), arb_mat(3, 6)
        p[0, 0], p[0, 4], p[1, 3], p[2, 2] = 3 * n * n, 2 * n, -2 * n, -n * n
        q[0, 3], q[1, 0], q[1, 4], q[2, 5] = -n, -6 * n * n, -4 * n, -n
        self.bends = p, q

    def held(self, event: Event) -> None:
        """Check the cells of an event."""
        self._held(event, self.sets.of(event))

    def _strays(self, event: Event, table: arb_mat, sizes: list[int]) -> list[list[arb]]:
        """How far each axis may be from the linear motion, up to the end of each part; empty in the linear model."""
        if self.asked.radius is None:
            return []
        h = self.duration(event) / len(event.radii)
        nodes = [_size(self._rows(h * k) * table, None, sizes) for k in range(len(event.radii) + 1)]
        between = arb(h * h / 8) * _size(self.bends[0] * table, self.bends[1] * table, sizes)
        linear = [arb.max(a, b) + between + self.sets.detour(event) for a, b in pairwise(nodes)]
        return strays(self.n, arb(self.asked.radius), arb(h), linear, [arb(r) for r in event.radii])

    def _held(self, event: Event, state: Reached) -> None:
        columns = [state.centre] + [m for block in state.blocks for m in block]
        table = arb_mat(6, len(columns))
        for j, entry in enumerate(columns):
            for k in range(6):
                table[k, j] = entry[k, 0]
        sizes = [len(block) for block in state.blocks]
        claim, strays, duration = (
            arb(self.asked.least),
            self._strays(event, table, sizes),
            self.duration(event),
        )
        for begin, end, *direction in event.cells:
            d = [arb(e) for e in direction]
            row = arb_mat([d])
            ends = [self._levels(row * self._rows(at) * table, sizes) for at in (begin, end)]
            one, two = (row * bend * table for bend in self.bends)
            span = arb(end - begin)
            rest = span * span / 8 * _swing(one, two, sizes) + _support(d, self.asked.zones[event.zone])
            if strays:
                # A cell that ends within a part gets the stray up to the end of that part.
                at = min(max(int((end * len(strays) / duration).ceil()), 1), len(strays))
                rest = rest + sum((abs(e) * s for e, s in zip(d, strays[at - 1], strict=True)), arb(0))
            room = arb.min(*ends) - rest - claim * sum((e * e for e in d), arb(0)).sqrt()
            if not (begin < end and any(direction) and room >= 0):
                raise ProofRejected(
                    f"{event.kind}, burn {event.burn}: distance >= {float(claim):.9g} m from {float(begin):.9g} to "
                    f"{float(end):.9g} s after it: short by {-float(room.mid()):.3g} (scaled by the direction)"
                )

    def _rows(self, at: fmpq) -> arb_mat:
        kept = self.rows.get(at)
        if kept is None:
            whole = transition(self.n, arb(at))
            kept = arb_mat([[whole[i, j] for j in range(6)] for i in range(3)])
            self.rows[at] = kept
        return kept

    @staticmethod
    def _levels(values: arb_mat, sizes: list[int]) -> arb:
        """f at one end."""
        level, at = values[0, 0], 1
        for size in sizes:
            level = level - _norm([values[0, at + j] for j in range(size)])
            at += size
        return level


def _size(one: arb_mat, two: arb_mat | None, sizes: list[int]) -> arb:
    """Bound on |(one cos + two sin) b| over the set whose centre and columns were multiplied."""
    total, at = arb(0), 0
    for size in [1, *sizes]:
        parts = [one] if two is None else [one, two]
        total = total + _norm([m[i, at + j] for m in parts for i in range(3) for j in range(size)])
        at += size
    return total


def _support(d: list[arb], zone: Zone) -> arb:
    """What a zone takes off the distance in the direction d."""

    def along(v: list[fmpq]) -> arb:
        return sum((e * arb(x) for e, x in zip(d, v, strict=True)), arb(0))

    return sum((_norm([along(v) for v in block]) for block in zone.blocks), along(zone.centre))


def _norm(entries: list[arb]) -> arb:
    """From above: where a column's image passes through zero, the square of its ball would reach below."""
    return sum((arb(e.abs_upper()) ** 2 for e in entries), arb(0)).sqrt()


def _swing(one: arb_mat, two: arb_mat, sizes: list[int]) -> arb:
    """sup over t of |(P cos + Q sin) . centre| + sum |M_k' (P cos + Q sin)|."""
    total, at = _norm([one[0, 0], two[0, 0]]), 1
    for size in sizes:
        total = total + _norm([m[0, at + j] for j in range(size) for m in (one, two)])
        at += size
    return total

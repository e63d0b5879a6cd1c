"""How far members may be from what a document states, in ball arithmetic, and what that takes from its distances.

*Angle k of the attitudes.* With w, w' the angular velocities of two bodies in their own axes the angle between the
bodies grows by at most |D|, D = w' - w. For a spin and a table |D| <= rate. Torque-free with moments I and J = I + E,
E diagonal, I D' = I (Q(w', w') - Q(w, w)) + what J changes:

    D' = 2 Q(w, D) + Q(D, D) + J^-1 (E w' x w' - E Q(w', w')).

The first term lets |D| grow by at most the largest eigenvalue of its symmetric part, a matrix of trace 0: at most
sqrt(2/3) of its size. |J^-1| <= (1 - |I^-1| |E|)^-1 |I^-1| entry by entry. A bound b with off + h slope(b) <= b holds
over a piece of h s, so |D| <= off + t slope(b) there.

*Distance y of the chasers.* The tide in inertial axes is at most g = 2 n^2 / (1 - e)^3, so
y = W (cosh(sqrt(g) t) - 1) / g. From y and y' at the begin of a span a square bounds it, as y'' = g y + W rises.

*Taken.* A face of the body loses at most k |r'| + y with |r'| <= |r| + y, and |r| <= (r . r + c^2) / 2 c for any c > 0;
for r = r0 + sum_j x_j r_j with |x_j| <= 1 this is linear in x but for at most count sum_j |r_j|^2 / 2 c.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from flint import arb, arb_poly, fmpq, fmpq_mat

from safestart.proofs.space.attitude import Body, Course, Piece
from safestart.proofs.space.motion import Stretch
from safestart.proofs.space.orbit import Orbit
from safestart.proofs.space.series import Series, between
from safestart.proofs.space.statement import SpaceStated
from safestart.proofs.space.unknowns import Unknowns
from safestart.proofs.strict import ProofRejected

_NEAREST_M = 0.5
# What (|r| - c)^2 / 2 c may take, m, decides how finely time is cut.
_LOOSE_M, _MOST_CUTS = 2e-4, 200


@dataclass(frozen=True, slots=True)
class Taken:
    """Over a span: what faces of LVLH and of the body lose, and of the latter more with each number of the start."""

    lvlh: arb_poly
    body: arb_poly
    leans: Series

    def from_face(
        self, room: arb_poly, less: Sequence[arb_poly], *, in_body: bool
    ) -> tuple[arb_poly, list[arb_poly]]:
        """A face's distance and how it falls with each number of the start, with the loss."""
        if not in_body:
            return room - self.lvlh, list(less)
        return room - self.body, [p + q for p, q in zip(less, self.leans, strict=True)]


class Spread:
    """The bounds of one statement's unknowns over all pieces of its attitude."""

    def __init__(self, stated: SpaceStated, course: Course, orbit: Orbit) -> None:
        if stated.unknowns is None:
            raise ValueError("a statement without unknowns")
        self.unknowns: Unknowns = stated.unknowns
        self._tide = 2 * orbit.n**2 / (1 - orbit.e) ** 3
        self._angles: dict[fmpq, arb_poly] = {}
        pieces = [piece for interval in course.pieces for piece in interval]
        unknowns = self.unknowns
        if stated.attitude.kind != "torque_free" or not (unknowns.rate > 0 or unknowns.inertia > 0):
            for piece in pieces:
                first = unknowns.angle + unknowns.rate * piece.begin
                self._angles[piece.begin] = arb_poly([arb(first), arb(unknowns.rate * piece.length)])
            return
        growth, off, angle = (
            _Growth(Body(stated.attitude.inertia), unknowns.inertia),
            arb(unknowns.rate),
            arb(unknowns.angle),
        )
        for piece in pieces:
            h = arb(piece.length)
            slope = growth.slope(piece, off, h)
            self._angles[piece.begin] = arb_poly([angle, h * off, h * h * slope / 2])
            angle, off = angle + h * off + h * h * slope / 2, off + h * slope

    def _drift(self, first: fmpq, last: fmpq) -> arb_poly:
        """A bound on y over a span, in shares of it: y'' = g y + W is largest at its end."""
        w, root = arb(self.unknowns.disturbance), self._tide.sqrt()

        def grown(x: arb) -> arb:
            return x.sinh() / x if x > 0 else arb(1)

        def y(time: fmpq) -> arb:
            return w * (arb(time) * grown(root * arb(time) / 2)) ** 2 / 2

        width, rate = arb(last - first), w * arb(first) * grown(root * arb(first))
        return arb_poly([y(first), width * rate, width**2 * (self._tide * y(last) + w) / 2])

    def spans(
        self, piece: Piece, stretch: Stretch, begin: fmpq, first: fmpq, last: fmpq
    ) -> list[tuple[fmpq, fmpq]]:
        """Parts of [``first``, ``last``] s in which one c is close enough to |r|; ``begin`` is the stretch's."""
        times = [arb((t - begin) / stretch.length) for t in (first, last)]
        ends = [[p(t) for p in stretch.flown[0][:3]] for t in times]
        gone = float(_most([b - a for a, b in zip(*ends, strict=True)]).upper())
        away = max(float(_size(ends[0]).lower()), _NEAREST_M)
        angle = float(self._angles[piece.begin](arb(1)).upper())
        # (|r| - c)^2 of a start beside the middle one: (s + w)^2 - w^2 is what a part takes, s its half, w the box's.
        wide = sum(float(_most([p(times[1]) for p in each[:3]]).upper()) for each in stretch.flown[1:])
        half = math.sqrt(wide * wide + 2.0 * away * _LOOSE_M / max(angle, 1e-12)) - wide
        count = min(max(1, math.ceil(0.5 * gone / half)), _MOST_CUTS)
        marks = [first + (last - first) * fmpq(i, count) for i in range(count + 1)]
        return list(pairwise(marks))

    def taken(self, piece: Piece, flown: list[Series], first: fmpq, last: fmpq) -> Taken:
        """Over a span of the piece; ``flown`` are the positions of the middle, and of each number of the start."""
        begin, width = (first - piece.begin) / piece.length, (last - first) / piece.length
        angle = between(self._angles[piece.begin], arb(begin), arb(width))
        drift = self._drift(first, last)
        middle, *moves = flown
        c = arb(max(float(_size([p(arb(0.5)) for p in middle]).mid()), _NEAREST_M))
        square = sum((p * p for p in middle), arb_poly([0]))
        square += len(moves) * sum((p * p for each in moves for p in each), arb_poly([0]))
        away = (square + c * c) * (1 / (2 * c))
        leans = [
            angle * sum((p * q for p, q in zip(middle, each, strict=True)), arb_poly([0])) * (1 / c)
            for each in moves
        ]
        return Taken(drift, angle * (away + drift) + drift, leans)


class _Growth:
    """Of |D| for one body whose moments may differ by ``share``."""

    def __init__(self, body: Body, share: fmpq) -> None:
        self.tensor = [[[arb(e) for e in row] for row in q] for q in body.tensor]
        self.q = arb(sum((e * e for q in body.tensor for row in q for e in row), fmpq(0))).sqrt()
        moments = [share * body.inertia[i][i] for i in range(3)]
        sizes = [[abs(e) for e in row] for row in body.inverse]
        reach = fmpq_mat([[e * m for e, m in zip(row, moments, strict=True)] for row in sizes])
        if any(sum((reach[i, j] for j in range(3)), fmpq(0)) >= 1 for i in range(3)):
            raise ProofRejected("inertia_share: required a share by which the inertia cannot become singular")
        unit = fmpq_mat([[fmpq(int(i == j)) for j in range(3)] for i in range(3)])
        inverse = (unit - reach).inv() * fmpq_mat(sizes)
        self._inverse = [[arb(inverse[i, j]) for j in range(3)] for i in range(3)]
        self._moments = [arb(m) for m in moments]

    def slope(self, piece: Piece, off: arb, h: arb) -> arb:
        """A bound on |D|' over the piece, where |D| <= ``off`` at its begin."""
        w = piece.rates
        matrix = [
            [sum((e * x for e, x in zip(row, w, strict=True)), arb(0)) for row in q] for q in self.tensor
        ]
        m = (arb(2) / 3).sqrt() * _most([matrix[i][j] + matrix[j][i] for i in range(3) for j in range(3)])
        turn = [sum((e * x for e, x in zip(row, w, strict=True)), arb(0)) for row in matrix]
        found = self._at(m, w, turn, off)
        for _ in range(20):
            guess = (off + h * found) * arb(1.0001)
            guess = arb(guess.upper())
            found = arb(self._at(m, w, turn, guess).upper())
            if off + h * found <= guess:
                return found
        raise ProofRejected("unknowns: no bound on the attitude up to the end")

    def _at(self, m: arb, w: list[arb], turn: list[arb], off: arb) -> arb:
        sizes = [arb(e.abs_upper()) + off for e in w]
        # Q(w', w') = Q(w, w) + 2 Q(w, D) + Q(D, D).
        more = self.q * off * (2 * _most(w) + off)
        turned = [arb(e.abs_upper()) + more for e in turn]
        a = self._moments
        source = [
            (a[j] + a[k]) * sizes[j] * sizes[k] + a[i] * turned[i]
            for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        ]
        held = [sum((e * s for e, s in zip(row, source, strict=True)), arb(0)) for row in self._inverse]
        return m * off + self.q * off * off + _most(held)


def _size(vector: list[arb]) -> arb:
    return sum((e * e for e in vector), arb(0)).sqrt()


def _most(vector: list[arb]) -> arb:
    """A bound on the size, also of what may be 0."""
    return sum((arb(e.abs_upper()) ** 2 for e in vector), arb(0)).sqrt()

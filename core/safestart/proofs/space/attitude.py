"""The attitude of one statement in ball arithmetic: C(t) from LVLH to the body, as series over pieces of intervals.

A spin and a table turn steadily between two times: Rodrigues' formula. A torque-free body is integrated: with w its
angular velocity against inertial axes, I w' = (I w) x w and C' = -[w x] C. Euler's equations are w' = Q(w, w), Q
bounded by q, so the coefficients of w are at most |w| (q |w|)^k; those of the columns of C, of length 1, then at most
4 tau^-k with tau = 1 / (2 q |w|), q >= 1/2. What leads from inertial axes is turned back by what LVLH has turned.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

from flint import arb, arb_mat, arb_poly, fmpq

from safestart.proofs.space.orbit import Orbit
from safestart.proofs.space.parts import Attitude
from safestart.proofs.space.series import Series, folded, picard, rest
from safestart.proofs.space.statement import SpaceStated
from safestart.proofs.strict import ProofRejected

_ORDER, _SHARE, _MOST = 22, 16.0, 50_000
Matrix = list[list[arb_poly]]
_WHOLE = arb(0.5, 0.5)


class Piece(NamedTuple):
    """C over [begin, begin + length] s; ``spin`` is the rate of what C turns against at its end, rad/s, body axes.

    ``rates`` holds that rate at all times of the piece, for a torque-free body.
    """

    begin: fmpq
    length: fmpq
    turn: Matrix
    spin: list[arb]
    rates: list[arb] = []  # noqa: RUF012 (no one changes it)


class Course:
    """The attitude over all intervals of a statement."""

    def __init__(self, stated: SpaceStated, orbit: Orbit) -> None:
        self.dt, self.orbit, self._inertial = stated.dt, orbit, stated.attitude.inertial
        made = {"spin": _spun, "table": _tabulated, "torque_free": _free}[stated.attitude.kind]
        inertial = stated.attitude.inertial
        self.pieces: list[list[Piece]] = []
        count = 0
        for interval in made(stated, orbit):
            seen = [self._in_lvlh(piece) for piece in interval] if inertial else interval
            self.pieces.append(seen)
            count += len(seen)
            if count > _MOST:
                raise ProofRejected(f"attitude: turns too fast for {_MOST} pieces")

    def _in_lvlh(self, piece: Piece) -> Piece:
        """C R^T with R the turn about z from inertial axes to LVLH."""
        c, s = self.orbit.turn(piece.begin, piece.length)
        turn = [[folded(x * c + y * s, _ORDER), folded(y * c - x * s, _ORDER), z] for x, y, z in piece.turn]
        return piece._replace(turn=turn)

    def at(self, time: fmpq) -> arb_mat:
        """C (3, 3) at a time."""
        k = min(int((time / self.dt).floor()), len(self.pieces) - 1)
        piece = self.pieces[k][-1]
        for candidate in self.pieces[k]:
            if time <= candidate.begin + candidate.length:
                piece = candidate
                break
        x = arb((time - piece.begin) / piece.length)
        return arb_mat(3, 3, [p(x) for row in piece.turn for p in row])

    def end(self, k: int) -> tuple[arb_mat, list[arb]]:
        """C (3, 3) at the end of interval k, and the body's rate against LVLH just before, rad/s, body axes."""
        piece, time = self.pieces[k][-1], self.dt * (k + 1)
        turn = arb_mat(3, 3, [p(arb(1)) for row in piece.turn for p in row])
        if not self._inertial:
            return turn, piece.spin
        pace = self.orbit.rate_at(time)
        return turn, [piece.spin[i] - pace * turn[i, 2] for i in range(3)]


def _marks(
    stated: SpaceStated, k: int, orbit: Orbit, rate: float, knots: list[fmpq]
) -> list[tuple[fmpq, fmpq]]:
    """Begin and length of the pieces of interval k for a turn of ``rate`` rad/s, cut at ``knots``."""
    longest = min(2.0 / max(rate, 1e-9), float(orbit.radius.lower()))
    count = max(1, math.ceil(_SHARE * float(arb(stated.dt)) / longest))
    if count * stated.steps > _MOST:
        raise ProofRejected(f"attitude: turns too fast for {_MOST} pieces")
    begin = stated.dt * k
    marks = {begin + stated.dt * fmpq(i, count) for i in range(count + 1)}
    marks |= {t for t in knots if begin < t < begin + stated.dt}
    ordered = sorted(marks)
    return [(a, b - a) for a, b in pairwise(ordered)]


def _rodrigues(axis: list[arb], angle: arb, rate: arb, length: fmpq) -> Matrix:
    """The turn by ``angle`` + rate x length, about a unit ``axis``: reference coordinates to body coordinates."""
    step = rate * arb(length)
    c, s = angle.cos(), angle.sin()
    cosine, sine, factor = [], [], arb(1)
    for k in range(_ORDER + 1):
        a, b = ((c, s), (-s, c), (-c, -s), (s, -c))[k % 4]
        cosine.append(a * factor)
        sine.append(b * factor)
        factor = factor * step / (k + 1)
    beyond = arb(0, (2 * factor).abs_upper()) if abs(step) < 1 else arb(0, 10)
    cos, sin = arb_poly(cosine) + beyond, arb_poly(sine) + beyond
    x, y, z = axis
    cross = [[arb(0), -z, y], [z, arb(0), -x], [-y, x, arb(0)]]
    out = []
    for i in range(3):
        row = []
        for j in range(3):
            along = axis[i] * axis[j]
            row.append(along + (arb(int(i == j)) - along) * cos - cross[i][j] * sin)
        out.append(row)
    return out


def _unit(vector: list[fmpq]) -> list[arb]:
    size = arb(sum((e * e for e in vector), fmpq(0))).sqrt()
    return [arb(e) / size for e in vector]


def _spun(stated: SpaceStated, orbit: Orbit) -> Iterator[list[Piece]]:
    said = stated.attitude
    axis, rate = _unit(said.axis), arb(said.rate)
    for k in range(stated.steps):
        yield [
            Piece(
                begin,
                length,
                _rodrigues(axis, arb(said.phase) + rate * arb(begin), rate, length),
                [rate * e for e in axis],
            )
            for begin, length in _marks(stated, k, orbit, abs(float(rate)), [])
        ]


def _matrix_of(q: list[fmpq]) -> list[list[fmpq]]:
    """C of a quaternion of any length, exactly."""
    s, x, y, z = q
    size = s * s + x * x + y * y + z * z
    rows = [
        [s * s + x * x - y * y - z * z, 2 * (x * y + s * z), 2 * (x * z - s * y)],
        [2 * (x * y - s * z), s * s - x * x + y * y - z * z, 2 * (y * z + s * x)],
        [2 * (x * z + s * y), 2 * (y * z - s * x), s * s - x * x - y * y + z * z],
    ]
    return [[e / size for e in row] for row in rows]


def _tabulated(stated: SpaceStated, orbit: Orbit) -> Iterator[list[Piece]]:
    said = stated.attitude
    times, entries = said.times, said.quaternions
    turns: dict[int, tuple[list[arb], arb, list[list[fmpq]]]] = {}
    index = 0
    for k in range(stated.steps):
        out = []
        fastest = 0.0
        begin_k, end_k = stated.dt * k, stated.dt * (k + 1)
        i = index
        while i < len(times) - 1 and times[i] < end_k:
            if times[i + 1] > begin_k:
                turns.setdefault(i, _steady(times, entries, i))
                fastest = max(fastest, abs(float(turns[i][1])))
            i += 1
        for begin, length in _marks(stated, k, orbit, fastest, times):
            while index < len(times) - 2 and times[index + 1] <= begin:
                index += 1
            axis, rate, first = turns[index]
            turn = _rodrigues(axis, rate * arb(begin - times[index]), rate, length)
            out.append(Piece(begin, length, _times_exact(turn, first), [rate * e for e in axis]))
        yield out


def _steady(times: list[fmpq], entries: list[list[fmpq]], i: int) -> tuple[list[arb], arb, list[list[fmpq]]]:
    """Axis and rate from entry i to the next, the shorter way, and C at entry i."""
    a, b = entries[i], entries[i + 1]
    s = sum((p * q for p, q in zip(a, b, strict=True)), fmpq(0))
    # conjugate(a) then b: the vector of b a*.
    v = [
        a[0] * b[1 + j] - b[0] * a[1 + j] - (a[1 + m] * b[1 + n] - a[1 + n] * b[1 + m])
        for j, m, n in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
    ]
    square = sum((e * e for e in v), fmpq(0))
    if square == 0:
        return [arb(0), arb(0), arb(1)], arb(0), _matrix_of(a)
    if s < 0:
        s, v = -s, [-e for e in v]
    rate = 2 * arb.atan2(arb(square).sqrt(), arb(s)) / arb(times[i + 1] - times[i])
    return _unit(v), rate, _matrix_of(a)


def _times_exact(turn: Matrix, first: list[list[fmpq]]) -> Matrix:
    given = [[arb(e) for e in row] for row in first]
    return [[sum((row[m] * given[m][j] for m in range(3)), arb_poly([0])) for j in range(3)] for row in turn]


def _free(stated: SpaceStated, orbit: Orbit) -> Iterator[list[Piece]]:
    said: Attitude = stated.attitude
    body = Body(said.inertia)
    state = [arb(e) for e in said.rate_vector]
    state += [arb(e) for row in _matrix_of(said.quaternions[0]) for e in row]
    for k in range(stated.steps):
        out = []
        speed = float(_size(state[:3]).upper())
        for begin, length in _marks(stated, k, orbit, 4.0 * float(body.quick.upper()) * speed, []):
            flown = body.flown(state, length)
            state = [p(arb(1)) for p in flown]
            turn, rates = [flown[3:6], flown[6:9], flown[9:12]], [p(_WHOLE) for p in flown[:3]]
            out.append(Piece(begin, length, turn, state[:3], rates))
        yield out


def _size(vector: list[arb]) -> arb:
    return sum((e * e for e in vector), arb(0)).sqrt()


class Body:
    """Euler's equations of one inertia tensor."""

    def __init__(self, inertia: list[list[fmpq]]) -> None:
        self.inertia = inertia
        a, b, c = inertia
        cofactors = [
            [b[1] * c[2] - b[2] * c[1], a[2] * c[1] - a[1] * c[2], a[1] * b[2] - a[2] * b[1]],
            [b[2] * c[0] - b[0] * c[2], a[0] * c[2] - a[2] * c[0], a[2] * b[0] - a[0] * b[2]],
            [b[0] * c[1] - b[1] * c[0], a[1] * c[0] - a[0] * c[1], a[0] * b[1] - a[1] * b[0]],
        ]
        size = sum((a[j] * cofactors[j][0] for j in range(3)), fmpq(0))
        inverse = self.inverse = [[e / size for e in row] for row in cofactors]
        # Q_i(x, y) = sum_jk tensor[i][j][k] x_j y_k, symmetric in j and k, of I^-1 ((I x) x y).
        cross = {
            (0, 1): (2, 1),
            (1, 0): (2, -1),
            (1, 2): (0, 1),
            (2, 1): (0, -1),
            (2, 0): (1, 1),
            (0, 2): (1, -1),
        }
        plain = [[[fmpq(0)] * 3 for _ in range(3)] for _ in range(3)]
        for (m, n), (p, sign) in cross.items():
            for i in range(3):
                for j in range(3):
                    plain[i][j][n] += sign * inverse[i][p] * inertia[m][j]
        self.tensor = [[[(q[j][k] + q[k][j]) / 2 for k in range(3)] for j in range(3)] for q in plain]
        norm = arb(sum((e * e for q in self.tensor for row in q for e in row), fmpq(0))).sqrt()
        self.quick = norm.max(arb(1) / 2)
        self._terms = [
            [
                (j, k, arb(q[j][k] * (1 if j == k else 2)))
                for j in range(3)
                for k in range(j, 3)
                if q[j][k] != 0
            ]
            for q in self.tensor
        ]

    def flown(self, state: list[arb], length: fmpq) -> Series:
        """Angular velocity (3) and the rows of C (9) over a piece."""
        found = picard(state, self._rates, arb(length), _ORDER)
        speed = _size(state[:3])
        ratio = 2 * self.quick * speed * arb(length)
        w, c = rest(speed, ratio, _ORDER), rest(arb(4), ratio, _ORDER)
        return [p + (w if i < 3 else c) for i, p in enumerate(found)]

    def _rates(self, y: Series) -> Series:
        w = y[:3]
        products = {(j, k): w[j] * w[k] for j in range(3) for k in range(j, 3)}
        out = [
            sum((factor * products[j, k] for j, k, factor in terms), arb_poly([0])) for terms in self._terms
        ]
        rows = (y[3:6], y[6:9], y[9:12])
        for i, j in ((1, 2), (2, 0), (0, 1)):
            # -(w x C): row n is w_j row_i - w_i row_j.
            out += [w[j] * p - w[i] * q for p, q in zip(rows[i], rows[j], strict=True)]
        return out

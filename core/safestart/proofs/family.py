"""Checker of proofs for families (schema ``safestart-proof-for-all/1``) in ball arithmetic.

Distances are proved at the nodes by balls, for every start of the box at once: a cubic's Bernstein coefficients are
affine in the start. The inequalities of docs/theory/uncertainty.md, derived here again, bound the values between the
nodes: a sinusoid between two of its values, and Gronwall's bound on the second derivative in the mean motion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import Any

from flint import arb, arb_mat, fmpq

from safestart.proofs.balls import PRECISION, Motion
from safestart.proofs.family_statement import StatedForAll, read
from safestart.proofs.refute import Refutation
from safestart.proofs.single import Verified
from safestart.proofs.statement import Stated
from safestart.proofs.strict import ProofRejected
from safestart.proofs.wording import lines_for_all
from safestart.runtime.precision import precise

_MOST_PIECES, _MOST_PARTS = 100_000, 4096
Row = tuple[arb, ...]


def check(document: Any) -> Verified:
    """Check a proof; raise :class:`ProofRejected` with the reason when it is malformed or an inequality fails."""
    stated = read(document)
    with precise(PRECISION):
        if stated.verdict == "GO":
            pieces = sum(_Flight(stated, case).go() for case in stated.cases)
        else:
            pieces = 0
            for case, rates in zip(stated.cases, stated.pieces, strict=True):
                _no_go(stated, case, rates)
    return Verified(stated.verdict, float(document["margin_m"]), pieces, lines_for_all(stated))


@dataclass(frozen=True, slots=True)
class _Reach:
    """Bounds for every member: |r(0)|, |v(0)|, 3 n^2 |r(0)| + a_max, growth, and |d2r/dn2| up to T."""

    far: arb
    fast: arb
    push: arb
    growth: arb
    bend: arb

    def within(self, t: arb) -> arb:
        """Bound on |r| up to the time t."""
        return self.far + self.growth * (t * self.fast + t * t * self.push / 2)


def _reach(stated: StatedForAll, case: Stated) -> _Reach:
    d, n, t = case.d, arb(stated.motions[-1]), arb(case.dt * case.steps)
    far, fast = (
        _norm([arb(e) for e in case.start[i : i + d]]) + _norm([arb(e) for e in stated.half[i : i + d]])
        for i in (0, d)
    )
    growth = (3 * (n * t) ** 2 / 2).exp()
    push = 3 * n * n * far + arb(case.a_max)
    r, v = far + growth * (t * fast + t * t * push / 2), growth * (fast + t * push)
    drive = 6 * n * r + 2 * v
    y, y_rate = t * t * drive * growth / 2, t * drive * growth
    return _Reach(far, fast, push, growth, t * t * growth * (12 * n * y + 4 * y_rate + 6 * r) / 2)


def _norm(vector: list[arb]) -> arb:
    return sum((e.abs_upper() ** 2 for e in vector), arb(0)).sqrt()


def _gap(values: list[fmpq]) -> fmpq:
    return max((b - a for a, b in pairwise(values)), default=fmpq(0))


class _Flight:
    """One history at one node, from every start of the box; distances are reduced by the bound between nodes."""

    def __init__(self, stated: StatedForAll, case: Stated) -> None:
        self.case, self.pieces, self.d = case, 0, case.d
        self.motion, self.half = Motion(case), [arb(e) for e in stated.half if e > 0]
        start, d = [arb(e) for e in case.start], case.d
        self.start = arb_mat(2 * d, 1, start)
        self.axes = [i for i, e in enumerate(stated.half) if e > 0]
        self.claim = arb(case.claim)
        between = arb(_gap(stated.motions)) ** 2 / 8 * _reach(stated, case).bend
        delta = arb(_gap(stated.rates) * case.dt * case.steps) / 2
        if not delta < 1:
            raise ProofRejected(
                "tumble_rates_rad_s: required nodes whose angles at T differ by less than 2 rad"
            )
        needed = self.claim + between
        self.faces = {}
        for name, (normal, offset) in case.faces.items():
            length = arb(sum((e * e for e in normal), fmpq(0))).sqrt()
            at_centre = arb(offset) / length
            # Faces that do not lean in x depend on the distance ahead of the target (hold_plane), so the worst rate is
            # a node.
            short = normal[0] != 0 and not needed >= at_centre
            level = at_centre - (at_centre - needed) * delta.cos() if short else needed
            self.faces[name] = ([arb(e) for e in normal], arb(offset), length, level)

    def go(self) -> int:
        """|u_k| <= a_max exactly, and every distance >= its level at all times; the number of pieces it took."""
        case, d = self.case, self.d
        phi, held = self.motion.over(arb(case.dt))
        state, still = self.start, arb_mat(d, 1)
        columns = [arb_mat(2 * d, 1, [arb(int(i == axis)) for i in range(2 * d)]) for axis in self.axes]
        for k, entry in enumerate(case.thrust):
            if sum((e * e for e in entry), fmpq(0)) > case.a_max**2:
                size, limit = float(_norm([arb(e) for e in entry])), float(arb(case.a_max))
                raise ProofRejected(
                    f"|u_{k}| <= a_max: |u| is {size:.17g}, the least a_max {limit:.17g} m/s^2"
                )
            u = arb_mat(d, 1, [arb(e) for e in entry])
            flights = [(state, u), *((column, still) for column in columns)]
            work = [(case.dt * (2 * i + 1) / 8, case.dt / 8) for i in range(4)]
            while work:
                centre, half = work.pop()
                if not self._piece(flights, k, centre, half):
                    work += [(centre - half / 2, half / 2), (centre + half / 2, half / 2)]
            state = phi * state + held * u
            columns = [phi * column for column in columns]
        return self.pieces

    def _piece(self, flights: list[tuple[arb_mat, arb_mat]], k: int, centre: fmpq, half: fmpq) -> bool:
        """Whether every level is proved on [centre - half, centre + half] of interval k; raise if one is false."""
        self.pieces += 1
        begin, middle, h = arb(self.case.dt * k), arb(centre), arb(half)
        taylor = []
        for state, u in flights:
            whole = middle + arb(0, 1) * h
            at = self.motion.body(*self.motion.rates(state, u, middle, 3), begin + middle)
            over = self.motion.body(*self.motion.rates(state, u, whole, 4), begin + whole)[4]
            taylor.append([[e * h**m / math.factorial(m) for e in q] for m, q in enumerate([*at, over])])
        proved = True
        for name, (normal, offset, length, level) in self.faces.items():
            rows = [_distance(normal, coefficients) for coefficients in taylor]
            # The worst start of the box, coefficient by coefficient: middle and Bernstein's four less the rest.
            low = [
                own - sum((w * abs(row[j]) for w, row in zip(self.half, rows[1:], strict=True)), arb(0))
                for j, own in enumerate(rows[0][:5])
            ]
            rest = rows[0][5] + sum((w * row[5] for w, row in zip(self.half, rows[1:], strict=True)), arb(0))
            room = offset - length * level
            if room + low[0] < 0 or self.pieces > _MOST_PIECES:
                raise ProofRejected(
                    f"distance to {name} >= margin_m for all at t = {float(begin + middle):.9g} s, tumble rate "
                    f"{float(self.motion.w):.9g} rad/s: the distance is {float((offset + low[0]) / length):.9g} m, "
                    f"required {float(level):.9g} m for the claim {float(self.claim):.9g} m"
                )
            proved = proved and all(room + low[j] - rest >= 0 for j in range(1, 5))
        return proved


def _distance(normal: list[arb], coefficients: list[list[arb]]) -> Row:
    """For -normal . q over a piece: its middle, its cubic's four Bernstein coefficients, a bound on the remainder."""
    a0, a1, a2, a3, a4 = (-sum((e * x for e, x in zip(normal, q, strict=True)), arb(0)) for q in coefficients)
    bends = (a2 - a1 - a3, a3 - (a1 + a2) / 3, (a1 - a2) / 3 - a3, a1 + a2 + a3)
    return (a0, *(a0 + bend for bend in bends), a4.abs_upper())


def _no_go(stated: StatedForAll, case: Stated, rates: list[fmpq]) -> None:
    """The weighted distances of one piece, at nodes close enough together, stay below the claim < 0."""
    reach, total, spin = _reach(stated, case), arb(0), arb(0)
    for weight in case.parts[0][2]:
        value, time = arb(weight.value), arb(weight.time or 0)
        total, spin = total + value, spin + value * time**2 * reach.within(time)
    claim, worst = arb(case.claim), arb(0)
    sides = [(rates[0], rates[1], spin), (stated.motions[0], stated.motions[-1], reach.bend * total)]
    parts = [1, 1]
    while total > 0 and claim < 0 and parts[0] * parts[1] <= _MOST_PARTS:
        gaps = [arb((b - a) / k) ** 2 / 8 * c for (a, b, c), k in zip(sides, parts, strict=True)]
        grid = [
            [a + (b - a) * i / k for i in range(k + 1 if a < b else 1)]
            for (a, b, _), k in zip(sides, parts, strict=True)
        ]
        bounds = [_bound(replace(case, w=w, n=n), stated.half) for w, n in product(*grid)]
        worst = max(bounds, key=float)
        if all(bound + gaps[0] + gaps[1] <= claim * total for bound in bounds):
            return
        if not all(bound <= claim * total for bound in bounds):
            break
        # Cut the side with the larger bound between its nodes in two.
        parts[0 if float(gaps[0]) >= float(gaps[1]) else 1] *= 2
    raise ProofRejected(
        f"sum of weighted distances <= margin_m < 0 for every thrust and member with tumble rate in "
        f"[{float(arb(rates[0])):.9g}, {float(arb(rates[1])):.9g}] rad/s: the bound is {float(worst):.9g} m over "
        f"weights {float(total):.9g}, the claim {float(claim):.9g} m"
    )


def _bound(case: Stated, half: list[fmpq]) -> arb:
    """Largest weighted sum of the distances over all thrusts and starts of the box, for one rate and mean motion."""
    _, bound, covector = Refutation(case).staying()
    for i, (middle, width) in enumerate(zip(case.start, half, strict=True)):
        bound += covector[0, i] * arb(middle) + covector[0, i].abs_upper() * arb(width)
    return bound

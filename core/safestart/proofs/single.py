"""Checker of proof documents (schema ``safestart-proof/1``) in ball arithmetic; it trusts nothing but python-flint.

It shares no code with the provers: it derives motion and turn (``balls.py``) and the corridor (``statement.py``) again.
It reads every number of a document as an exact double, every operation carries its error, and a comparison counts only
when it holds for the whole ball. docs/theory/exact.md states the inequalities.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from flint import arb, arb_mat, fmpq

from safestart.proofs.balls import PRECISION, Motion
from safestart.proofs.hold.check import Hold
from safestart.proofs.refute import refute
from safestart.proofs.statement import Stated, read
from safestart.proofs.strict import ProofRejected
from safestart.proofs.wording import lines
from safestart.runtime.precision import precise

_MOST_PIECES = 100_000


@dataclass(frozen=True, slots=True)
class Verified:
    """What a document proves: its verdict and the margin (m) that bounds the best one, from below (GO) or above.

    For a plan with failing burns the verdict is PROVED and the margin its least distance to the target.

    ``pieces`` is the number of time intervals it took, 0 for a NO_GO. ``statement`` lists all that is
    proved, line by line.
    """

    verdict: str
    margin_m: float
    pieces: int
    statement: tuple[str, ...]


def check(document: Any) -> Verified:
    """Check a proof; raise :class:`ProofRejected` with the reason when it is malformed or an inequality fails."""
    stated = read(document)
    with precise(PRECISION):
        pieces = Witness(stated).check() if stated.verdict == "GO" else refute(stated)
    return Verified(stated.verdict, float(document["margin_m"]), pieces, lines(stated))


def _square(vector: list[arb]) -> arb:
    return sum((e * e for e in vector), arb(0))


class Witness:
    """The thrust history of one statement, flown in balls; each face's distance is reduced by ``taken`` (m)."""

    def __init__(self, stated: Stated, taken: Mapping[str, arb] | None = None) -> None:
        self.stated, self.pieces = stated, 0
        self.d, self.dt = stated.d, stated.dt
        self.motion, self.claim, self.limits = Motion(stated), arb(stated.claim), stated.limits
        self.faces = {}
        for name, (normal, offset) in stated.faces.items():
            length = arb(sum((e * e for e in normal), fmpq(0))).sqrt()
            room = arb(offset) / length - (taken or {}).get(name, arb(0))
            self.faces[name] = [arb(e) / length for e in normal], room
        self.start = arb_mat(2 * self.d, 1, [arb(e) for e in stated.start])

    def check(self) -> int:
        """Check |u_k| <= a_max exactly, and every margin >= the claim > 0 at all times, those of the end at the end.

        Returns the number of pieces of time; raises :class:`ProofRejected`.
        """
        phi, held = self.motion.over(arb(self.dt))
        state = self.start
        for k, entry in enumerate(self.stated.thrust):
            norm, limit = sum((e * e for e in entry), fmpq(0)), self.stated.a_max
            if norm > limit**2:
                size = math.sqrt(float(arb(norm)))
                raise ProofRejected(
                    f"|u_{k}| <= a_max: |u| is {size:.17g}, a_max {float(arb(limit)):.17g} m/s^2"
                )
            u = arb_mat(self.d, 1, [arb(e) for e in entry])
            work = [(self.dt * (2 * i + 1) / 8, self.dt / 8) for i in range(4)]
            while work:
                centre, half = work.pop()
                if not self._piece(state, u, k, centre, half):
                    work += [(centre - half / 2, half / 2), (centre + half / 2, half / 2)]
            state = phi * state + held * u
        if self.limits.hold is not None:
            self._end(state, arb(self.dt * len(self.stated.thrust)))
        if self.stated.held is not None:
            most = None if self.limits.most is None else arb(self.limits.most)
            hold = Hold(self.stated.held, self.motion, arb(self.dt), self.faces, arb(self.stated.a_max), most)
            hold.check(state, arb(self.dt * len(self.stated.thrust)))
        return self.pieces

    def _end(self, state: arb_mat, time: arb) -> None:
        """Check the ball around the hold point, and the speed relative to the body frame."""
        flat, high = self.motion.rates(state, arb_mat(self.d, 1), arb(0), 1)
        at, speed = self.motion.body(flat, high, time)
        radius = arb(self.limits.radius)
        away = [e - arb(h) for e, h in zip(at, self.limits.hold or [], strict=True)]
        for name, used in (
            ("hold", _square(away).sqrt()),
            ("rest", arb(self.limits.rest_scale) * _square(speed).sqrt()),
        ):
            if not radius - used >= self.claim:
                raise ProofRejected(
                    f"margin of {name} >= margin_m at the end, t = {float(time):.9g} s: it is "
                    f"{float(radius - used):.9g} m, the claim {float(self.claim):.9g} m"
                )
        if self.stated.arrival is not None:
            self._after(at, speed, *map(arb, self.stated.arrival))

    def _after(self, at: list[arb], speed: list[arb], stop: arb, margin: arb) -> None:
        """Check thrust, distances and speed of a stop in ``stop`` s from body position ``at``, and of standing then.

        The chaser goes on straight along ``speed`` v and slows down evenly to p + v stop / 2; docs/theory/exact.md.
        """
        fast, spin = _square(speed).sqrt(), self.motion.w + self.motion.n
        far = _square(at).sqrt() + fast * stop / 2
        needed = fast / stop + 2 * spin * fast + (spin * spin + 2 * self.motion.n * self.motion.n) * far
        if not needed <= arb(self.stated.a_max):
            raise ProofRejected(
                f"arrival.stop_s: the stop may take {float(needed):.9g} m/s^2, "
                f"a_max is {float(arb(self.stated.a_max)):.9g}"
            )
        if self.limits.most is not None and not fast + self.motion.w * far <= arb(self.limits.most):
            raise ProofRejected(
                f"arrival: the speed may reach {float(fast + self.motion.w * far):.9g} m/s in LVLH"
            )
        for name, (normal, room) in self.faces.items():
            for share in (arb(0), stop / 2):
                left = room - sum(
                    (e * (p + share * v) for e, p, v in zip(normal, at, speed, strict=True)), arb(0)
                )
                if not left >= margin:
                    raise ProofRejected(
                        f"arrival.margin_m: the distance to {name} comes down to {float(left):.9g} m, the claim is "
                        f"{float(margin):.9g} m"
                    )

    def _piece(self, state: arb_mat, u: arb_mat, k: int, centre: fmpq, half: fmpq) -> bool:
        """Whether the claim is proved on [centre - half, centre + half] of interval k; raise if it is false."""
        self.pieces += 1
        begin, middle, h = arb(self.dt * k), arb(centre), arb(half)
        proved = True
        at = self._room(state, u, begin, middle, range(4))
        over = self._room(state, u, begin, middle + arb(0, 1) * h, range(4, 5))
        for (name, rates), (_, around) in zip(at, over, strict=True):
            level, a1, a2, a3, a4 = (
                rate * h**m / math.factorial(m) for m, rate in enumerate([*rates, *around])
            )
            if level < 0 or self.pieces > _MOST_PIECES:
                raise ProofRejected(
                    f"{name} >= margin_m = {float(self.claim):.9g} m at t = {float(begin + middle):.9g} s: "
                    f"short by {-float(level):.9g} (m for a distance, m^2/s^2 for a speed)"
                    + ("" if level < 0 else f", not settled after {_MOST_PIECES} pieces")
                )
            rest = level - a4.abs_upper()
            # The cubic's Bernstein coefficients bound it from below; the fourth derivative bounds the remainder.
            bends = (a2 - a1 - a3, a3 - (a1 + a2) / 3, (a1 - a2) / 3 - a3, a1 + a2 + a3)
            proved = proved and all(rest + bend >= 0 for bend in bends)
        return proved

    def _room(
        self, state: arb_mat, u: arb_mat, begin: arb, s: arb, orders: range
    ) -> Iterator[tuple[str, list[arb]]]:
        """Time derivatives, of the requested orders at begin + s, of the quantity that must not be negative."""
        most, highest = self.limits.most, orders[-1]
        flat, high = self.motion.rates(state, u, s, highest + (most is not None))
        chain = self.motion.body(flat[: highest + 1], high, begin + s)
        for name, (normal, offset) in self.faces.items():
            rates = [-sum((e * x for e, x in zip(normal, chain[m], strict=True)), arb(0)) for m in orders]
            if orders[0] == 0:
                rates[0] += offset - self.claim
            yield f"distance to {name}", rates
        if most is not None:
            # |v| <= most - claim / scale, squared.
            limit = arb(most) - self.claim / arb(self.limits.scale)
            if not limit >= 0:
                raise ProofRejected("margin_m: required at most scale_s times the speed limit")
            rates = [-self.motion.speed_squared(flat, high, m) for m in orders]
            if orders[0] == 0:
                rates[0] += limit * limit
            yield "margin of speed", rates

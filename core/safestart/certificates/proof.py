"""Checker of proof documents (schema ``safestart-proof/1``) in ball arithmetic; it trusts nothing but python-flint.

It shares no code with what makes the proofs: CWH motion, the turning frame and (in ``statement.py``) the corridor are
derived here again. Every number of a document is the double it is, every operation carries its error, and a comparison
counts only when it holds for the whole ball. docs/theory/exact.md states the inequalities.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from flint import acb, arb, arb_mat, ctx, fmpq

from safestart.certificates.statement import ProofRejected, Stated, read

_PRECISION = 160
_MOST_PIECES = 100_000


@dataclass(frozen=True, slots=True)
class Verified:
    """What a document proves: its verdict and the margin (m) that bounds the best one, from below (GO) or above.

    ``pieces`` is the number of time intervals a GO took, 0 for a NO_GO.
    """

    verdict: str
    margin_m: float
    pieces: int


def check(document: Any) -> Verified:
    """Check a proof; raise :class:`ProofRejected` with the reason when it is malformed or an inequality fails."""
    stated = read(document)
    with ctx.workprec(_PRECISION):
        case = _Case(stated)
        case.go() if stated.verdict == "GO" else case.no_go()
    return Verified(stated.verdict, float(document["margin_m"]), case.pieces)


def _phases(p: arb) -> tuple[arb, arb, arb]:
    """sin(p)/p, (1 - cos p)/p^2, (p - sin p)/p^3: alternating series, the first term left out bounds the error."""
    square, term = p * p, arb(1)
    f1 = f2 = f3 = arb(0)
    for k in range(0, 400, 2):
        f1, f2, f3 = (
            f1 + term / (k + 1),
            f2 + term / ((k + 1) * (k + 2)),
            f3 + term / ((k + 1) * (k + 2) * (k + 3)),
        )
        term = -term * square / ((k + 1) * (k + 2))
        if square < (k + 3) * (k + 4) and abs(term) < arb(2) ** -_PRECISION:
            rest = arb(0, term.abs_upper())
            return f1 + rest, f2 + rest, f3 + rest
    raise ProofRejected("mean_motion_rad_s * dt_s: the series does not converge")


class _Case:
    """One statement: its motion and its two kinds of proof."""

    def __init__(self, stated: Stated) -> None:
        self.stated, self.pieces = stated, 0
        self.d, self.steps, self.dt = stated.d, stated.steps, stated.dt
        self.n, self.w, self.claim = arb(stated.n), arb(stated.w), arb(stated.claim)
        self.faces = {
            name: ([arb(e) for e in normal], arb(offset), arb(sum((e * e for e in normal), fmpq(0))).sqrt())
            for name, (normal, offset) in stated.faces.items()
        }
        self.start = arb_mat(2 * self.d, 1, [arb(e) for e in stated.start])

    def motion(self, s: arb) -> tuple[arb_mat, arb_mat]:
        """Phi(s), (2 d, 2 d), and its zero-order-hold integral B(s), (2 d, d)."""
        n, d, p = self.n, self.d, self.n * s
        f1, f2, f3 = _phases(p)
        sine, versine = s * f1, p * p * f2
        phi, held = arb_mat(2 * d, 2 * d), arb_mat(2 * d, d)
        phi[0, 0], phi[0, d], phi[0, d + 1] = 1 + 3 * versine, sine, 2 * s * p * f2
        phi[1, 0], phi[1, 1], phi[1, d], phi[1, d + 1] = (
            -6 * p**3 * f3,
            arb(1),
            -2 * s * p * f2,
            4 * sine - 3 * s,
        )
        phi[d, 0], phi[d, d], phi[d, d + 1] = 3 * n * p * f1, 1 - versine, 2 * p * f1
        phi[d + 1, 0], phi[d + 1, d], phi[d + 1, d + 1] = -6 * n * versine, -2 * p * f1, 1 - 4 * versine
        square, sweep = s * s * f2, 2 * s * s * p * f3
        held[0, 0], held[0, 1], held[1, 0], held[1, 1] = square, sweep, -sweep, 4 * square - 3 * s * s / 2
        held[d, 0], held[d, 1], held[d + 1, 0], held[d + 1, 1] = (
            sine,
            2 * s * p * f2,
            -2 * s * p * f2,
            4 * sine - 3 * s,
        )
        if d == 3:
            phi[2, 2], phi[2, 5], phi[5, 2], phi[5, 5] = 1 - versine, sine, -n * p * f1, 1 - versine
            held[2, 2], held[5, 2] = square, sine
        return phi, held

    def go(self) -> None:
        """|u_k| <= a_max exactly, and every face distance >= the claim > 0 at all times."""
        if not self.claim > 0:
            raise ProofRejected(f"margin_m: required > 0 for GO, received {float(self.claim):.9g}")
        phi, held = self.motion(arb(self.dt))
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

    def _piece(self, state: arb_mat, u: arb_mat, k: int, centre: fmpq, half: fmpq) -> bool:
        """Whether the claim is proved on [centre - half, centre + half] of interval k; raise where it is false."""
        self.pieces += 1
        begin, middle, h = arb(self.dt * k), arb(centre), arb(half)
        at = self.derivatives(state, u, begin, middle, 3)
        over = self.derivatives(state, u, begin, middle + arb(0, 1) * h, 4)[4]
        proved = True
        for name, (normal, offset, length) in self.faces.items():
            a0, a1, a2, a3, a4 = (
                -sum((e * x for e, x in zip(normal, q, strict=True)), arb(0)) * h**m / math.factorial(m)
                for m, q in enumerate([*at, over])
            )
            level = offset + a0 - length * self.claim
            if level < 0 or self.pieces > _MOST_PIECES:
                raise ProofRejected(
                    f"distance to {name} >= margin_m at t = {float(begin + middle):.9g} s: the distance is "
                    f"{float((offset + a0) / length):.9g} m, the claim {float(self.claim):.9g} m"
                    + ("" if level < 0 else f", not settled after {_MOST_PIECES} pieces")
                )
            rest = level - a4.abs_upper()
            # The cubic's Bernstein coefficients bound it from below; the fourth derivative bounds what is left.
            bends = (a2 - a1 - a3, a3 - (a1 + a2) / 3, (a1 - a2) / 3 - a3, a1 + a2 + a3)
            proved = proved and all(rest + bend >= 0 for bend in bends)
        return proved

    def derivatives(self, state: arb_mat, u: arb_mat, begin: arb, s: arb, order: int) -> list[list[arb]]:
        """Body-frame position R(-w t) r(t), t = begin + s, and its time derivatives up to ``order``."""
        phi, held = self.motion(s)
        x, n, d = phi * state + held * u, self.n, self.d
        flat = [acb(x[0, 0], x[1, 0]), acb(x[d, 0], x[d + 1, 0])]
        high = [x[2, 0], x[5, 0]] if d == 3 else []
        for m in range(order - 1):
            push = acb(u[0, 0], u[1, 0]) if m == 0 else acb(0)
            r, v = flat[m], flat[m + 1]
            flat.append(acb(3 * n * n * r.real + 2 * n * v.imag, -2 * n * v.real) + push)
            if d == 3:
                high.append(-n * n * high[m] + (u[2, 0] if m == 0 else 0))
        angle = self.w * (begin + s)
        turn, spin = acb(angle.cos(), -angle.sin()), acb(0, -1) * self.w
        out = []
        for m in range(order + 1):
            q = turn * flat[0]
            out.append([q.real, q.imag, *high[m : m + 1]])
            # d/dt (turn g) = turn (g' - i w g), applied to the whole chain of derivatives.
            flat = [after + spin * now for now, after in pairwise(flat)]
        return out

    def no_go(self) -> None:
        """Weights >= 0 of face distances whose sum no admissible thrust history brings above the claim < 0."""
        total = bound = arb(0)
        sorted_in: dict[int, list[tuple[arb, arb_mat]]] = {}
        for time, face, exact_value in self.stated.weights:
            value = arb(exact_value)
            k = min(int((time / self.dt).floor()), self.steps - 1)
            normal, offset, length = self.faces[face]
            angle, weight = self.w * arb(time), value / length
            c, s = angle.cos(), angle.sin()
            turned = [c * normal[0] - s * normal[1], s * normal[0] + c * normal[1], *normal[2:]]
            covector = arb_mat(1, 2 * self.d, [-weight * e for e in turned] + [arb(0)] * self.d)
            sorted_in.setdefault(k, []).append((arb(time - self.dt * k), covector))
            total, bound = total + value, bound + weight * offset
        phi, held = self.motion(arb(self.dt))
        carried, a_max = arb_mat(1, 2 * self.d), arb(self.stated.a_max)
        for k in reversed(range(self.steps)):
            pull, carried = carried * held, carried * phi
            for s, covector in sorted_in.get(k, []):
                phi_s, held_s = self.motion(s)
                pull, carried = pull + covector * held_s, carried + covector * phi_s
            bound += a_max * sum((pull[0, i].abs_upper() ** 2 for i in range(self.d)), arb(0)).sqrt()
        bound += (carried * self.start)[0, 0]
        if not (total > 0 and bound < 0 and bound <= self.claim * total and self.claim < 0):
            raise ProofRejected(
                f"sum of weighted distances <= margin_m < 0 for every thrust: the bound is {float(bound):.9g} m "
                f"over weights {float(total):.9g}, the claim {float(self.claim):.9g} m"
            )

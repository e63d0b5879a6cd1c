"""CWH motion and the turning frame in ball arithmetic, the checker's own (:mod:`safestart.proofs.single`)."""

from __future__ import annotations

import math
from itertools import pairwise

from flint import acb, arb, arb_mat

from safestart.proofs.statement import Stated
from safestart.proofs.strict import ProofRejected

PRECISION = 160


def _phases(p: arb) -> tuple[arb, arb, arb]:
    """sin(p)/p, (1 - cos p)/p^2, (p - sin p)/p^3: alternating series whose first omitted term bounds the error."""
    square, term = p * p, arb(1)
    f1 = f2 = f3 = arb(0)
    for k in range(0, 400, 2):
        f1, f2, f3 = (
            f1 + term / (k + 1),
            f2 + term / ((k + 1) * (k + 2)),
            f3 + term / ((k + 1) * (k + 2) * (k + 3)),
        )
        term = -term * square / ((k + 1) * (k + 2))
        if square < (k + 3) * (k + 4) and abs(term) < arb(2) ** -PRECISION:
            rest = arb(0, term.abs_upper())
            return f1 + rest, f2 + rest, f3 + rest
    raise ProofRejected("mean_motion_rad_s * dt_s: the series does not converge")


class Motion:
    """The motion of one statement: mean motion and tumble rate (rad/s) as balls, 2 or 3 dimensions."""

    def __init__(self, stated: Stated) -> None:
        self.d, self.n, self.w = stated.d, arb(stated.n), arb(stated.w)

    def over(self, s: arb) -> tuple[arb_mat, arb_mat]:
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

    def rates(self, state: arb_mat, u: arb_mat, s: arb, order: int) -> tuple[list[acb], list[arb]]:
        """LVLH position at s seconds under thrust u, and its derivatives up to ``order``: x + i y, and z in 3-D."""
        phi, held = self.over(s)
        x, n, d = phi * state + held * u, self.n, self.d
        flat = [acb(x[0, 0], x[1, 0]), acb(x[d, 0], x[d + 1, 0])]
        high = [x[2, 0], x[5, 0]] if d == 3 else []
        for m in range(order - 1):
            push = acb(u[0, 0], u[1, 0]) if m == 0 else acb(0)
            r, v = flat[m], flat[m + 1]
            flat.append(acb(3 * n * n * r.real + 2 * n * v.imag, -2 * n * v.real) + push)
            if d == 3:
                high.append(-n * n * high[m] + (u[2, 0] if m == 0 else 0))
        return flat, high

    def speed_squared(self, flat: list[acb], high: list[arb], m: int) -> arb:
        """The m-th time derivative of |v|^2 in LVLH, by Leibniz, from the derivatives of the position."""
        v = [[g.real, g.imag, *high[j + 1 : j + 2]] for j, g in enumerate(flat[1:])]
        return sum(
            (math.comb(m, j) * a * b for j in range(m + 1) for a, b in zip(v[j], v[m - j], strict=True)),
            arb(0),
        )

    def body(self, flat: list[acb], high: list[arb], time: arb) -> list[list[arb]]:
        """Body-frame position R(-w t) r(t) and its derivatives, from those in LVLH."""
        angle = self.w * time
        turn, spin = acb(angle.cos(), -angle.sin()), acb(0, -1) * self.w
        out = []
        for m in range(len(flat)):
            q = turn * flat[0]
            out.append([q.real, q.imag, *high[m : m + 1]])
            # d/dt (turn g) = turn (g' - i w g), applied to the whole chain of derivatives.
            flat = [after + spin * now for now, after in pairwise(flat)]
        return out

"""Pushes in LVLH at other times than the planned one, as equivalent states then, in ball arithmetic.

f(t) = Phi(0, t) (0, e) for a push e that turns with LVLH; f'(t) = Phi(0, t) (-e, omega x e). On a piece of times f' is
enclosed in a ball: f lies within the tangent in the middle and the ball's radius times half the piece, the integral of
f within the value in the middle times the length and a quarter of the square of the length times that radius.

A burn with a duration takes f's integral by the midpoints of equal parts of length w, each within w^3/24 |f''|, where

    f'' = Phi(0, t) (-2 omega x e, G e + omega x (omega x e) + omega' x e).
"""

from __future__ import annotations

from flint import arb, arb_mat, fmpq

from safestart.proofs.abort.earth.course import Course, inverse
from safestart.proofs.abort.earth.taylor import middle
from safestart.proofs.abort.earth.turning import Turning
from safestart.proofs.abort.finite import Rates
from safestart.proofs.abort.reached import Reached, axes, column, shell

Limits = tuple[arb, arb]
_BALL = arb(0, 1)
_PARTS = 64


def frame(target: Course, time: arb) -> tuple[arb_mat, arb_mat]:
    """LVLH axes as rows (3, 3), inertial, and omega x (3, 3) in LVLH, of the target at a time, also a ball."""
    r, v = (list(m.entries()) for m in target.state(time))
    size = _length(r)
    h = [r[1] * v[2] - r[2] * v[1], r[2] * v[0] - r[0] * v[2], r[0] * v[1] - r[1] * v[0]]
    momentum = _length(h)
    x, z = [e / size for e in r], [e / momentum for e in h]
    y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]]
    # Only J2 pulls out of the orbit's plane: -3 mu J2 R^2 z / r^5 along the Earth's axis.
    across = -3 * target.bulge * arb(target.rate) ** 2 * r[2] / size**5 * z[2]
    tilt, turn, zero = size * across / momentum, momentum / (size * size), arb(0)
    return arb_mat([x, y, z]), arb_mat([[zero, -turn, zero], [turn, zero, -tilt], [zero, tilt, zero]])


def lift(target: Course, time: arb) -> arb_mat:
    """(6, 6): LVLH states as inertial ones relative to the target."""
    rows, turn = frame(target, time)
    back = rows.transpose()
    zero = [arb(0)] * 3
    return arb_mat(
        [row + zero for row in back.tolist()]
        + [a + b for a, b in zip((back * turn).tolist(), back.tolist(), strict=True)]
    )


class Pushes:
    """Pushes on a chaser near the course of a reference, from ``begin`` s of the target's course on; ``k``: the root of
    a bound on |G|, 1/s. Times in s after ``begin``."""

    def __init__(self, target: Course, reference: Course, begin: fmpq, k: arb) -> None:
        self.target, self.reference, self.begin, self.k = target, reference, begin, k

        self.known: dict[fmpq, arb_mat] = {}

    def at(self, time: fmpq) -> arb_mat:
        """f (6, 3) per unit of e."""
        found = self.known.get(time)
        if found is None:
            rows, _ = frame(self.target, arb(self.begin + time))
            found = self.known[time] = _right(self._back(time)) * rows.transpose()
        return found

    def _back(self, at: fmpq) -> arb_mat:
        """Phi(0, at)."""
        return inverse(self.reference.motion(arb(at)))

    def _slope(self, first: fmpq, last: fmpq) -> arb_mat:
        """f' (6, 3) over a piece, as balls."""
        at, reach = (first + last) / 2, arb((last - first) / 2)
        rows, turn = frame(self.target, arb(self.begin + at) + _BALL * reach)
        back = rows.transpose()
        whole = arb_mat((-1 * back).tolist() + (back * turn).tolist())
        # Phi(at, t), |t - at| <= reach: I, the time, and what |G| <= k^2 allows.
        p = self.k * reach
        even, odd = _BALL * (p.cosh() - 1), _BALL * (p.sinh() / self.k)
        pull = _BALL * (self.k * p.sinh())
        near = arb_mat(6, 6)
        for i in range(3):
            for j in range(3):
                near[i, j] = near[i + 3, j + 3] = even + int(i == j)
                near[i, j + 3] = _BALL * (p.sinh() / self.k - reach) + (odd if i == j else 0)
                near[i + 3, j] = pull
        return self._back(at) * (near * whole)

    def late(self, before: Reached, impulse: list[arb], limits: Limits, first: fmpq, last: fmpq) -> Reached:
        """A burn that comes first to last s late."""
        along, one, two, size = axes(impulse)
        centre, half, across = shell(1 - limits[0], 1 + limits[0], limits[1])
        at, reach = (first + last) / 2, arb((last - first) / 2)
        f, slope = self.at(at), self._slope(first, last)
        tangent = slope * column([size * centre * e for e in along])
        wide = slope * column([_BALL * (size * (half * half + across * across).sqrt())] * 3)
        blocks = [
            [f * column([size * half * e for e in along])],
            [f * column([size * across * e for e in unit]) for unit in (one, two)],
            [reach * middle(tangent)],
        ]
        out = Reached(
            before.centre + f * column([size * centre * e for e in along]), [*before.blocks, *blocks]
        )
        return out.grown([reach * (_radius(tangent[k, 0]) + arb(wide[k, 0].abs_upper())) for k in range(6)])

    def stuck(
        self, after: Reached, impulse: list[arb], thrust: arb, limits: Limits, first: fmpq, last: fmpq
    ) -> Reached:
        """The thrust goes on for first to last s after the burn."""
        along, _, _, _ = axes(impulse)
        centre, half, across = shell(1 - limits[0], 1 + limits[0], limits[1])
        push = column([thrust * centre * e for e in along])
        at, reach = (first + last) / 2, arb((last - first) / 2)
        # The integral up to the middle of the piece, in pieces no longer than this one.
        count = max(int((at / (last - first)).ceil()), 1)
        total, width = column([arb(0)] * 6), at / count
        for j in range(count):
            begun = width * j
            slope = self._slope(begun, begun + width) * push
            total = total + arb(width) * (self.at(begun + width / 2) * push)
            total = total + column(
                [_BALL * (_radius(slope[k, 0]) * arb(width * width / 4)) for k in range(6)]
            )
        tangent = self.at(at) * push
        bent = self._slope(first, last) * push
        state = Reached(after.centre + total, [*after.blocks, [reach * tangent]])
        loose, p = thrust * (half * half + across * across).sqrt(), self.k * arb(last)
        kicked = [(p.cosh() - 1) / self.k**2] * 3 + [p.sinh() / self.k] * 3
        return state.grown(
            [reach * reach / 2 * arb(bent[k, 0].abs_upper()) + loose * kicked[k] for k in range(6)]
        )


class LastingPushes(Pushes):
    """Those of a burn with a duration, up to ``longest`` s after its planned time."""

    def __init__(
        self, target: Course, reference: Course, begin: fmpq, k: arb, longest: fmpq, turning: Turning
    ) -> None:
        super().__init__(target, reference, begin, k)
        self.longest, self.turning = longest, turning
        self.second = self.rates(longest).second
        self.sums = [arb_mat(6, 3)]

    def rates(self, longest: fmpq) -> Rates:
        """Bounds on f' and f'' up to ``longest`` s."""
        k, spin, both = self.k, self.turning.spin, self.k**2 + self.turning.bend
        p = k * arb(longest)
        even, odd = p.cosh(), p.sinh()
        first = [even + spin / k * odd] * 3 + [k * odd + spin * even] * 3
        second = [2 * spin * even + both / k * odd] * 3 + [2 * spin * k * odd + both * even] * 3
        return Rates([arb(e.abs_upper()) for e in first], [arb(e.abs_upper()) for e in second])

    def total(self, time: fmpq) -> arb_mat:
        """The integral of f (6, 3) from 0 to ``time``."""
        part = self.longest / _PARTS
        whole = int((time / part).floor())
        while len(self.sums) <= whole:
            self.sums.append(self.sums[-1] + self._midpoint(part * (len(self.sums) - 1), part))
        left = time - part * whole
        return self.sums[whole] + self._midpoint(part * whole, left) if left > 0 else self.sums[whole]

    def _midpoint(self, begin: fmpq, length: fmpq) -> arb_mat:
        out = self.at(begin + length / 2) * arb(length)
        for k in range(6):
            for j in range(3):
                out[k, j] += _BALL * (arb(length) ** 3 / 24 * self.second[k])
        return out


def _length(v: list[arb]) -> arb:
    return sum((e * e for e in v), arb(0)).sqrt()


def _radius(ball: arb) -> arb:
    return arb(ball.rad())


def _right(matrix: arb_mat) -> arb_mat:
    return arb_mat([row[3:] for row in matrix.tolist()])

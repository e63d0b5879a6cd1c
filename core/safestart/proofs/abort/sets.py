"""The checker's own sets of a chaser's possible states after each event, in ball arithmetic.

States are (x, y, z, vx, vy, vz), LVLH. A set is a centre and blocks of columns M_k b_k, |b_k|_2 <= 1.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from flint import arb, arb_mat, fmpq

from safestart.proofs.abort.statement import Asked, Event


def transition(n: arb, t: arb) -> arb_mat:
    """CWH transition matrix over t s; t may be a ball and negative."""
    s, c = (n * t).sin(), (n * t).cos()
    zero, one = arb(0), arb(1)
    return arb_mat(
        [
            [4 - 3 * c, zero, zero, s / n, 2 * (1 - c) / n, zero],
            [6 * (s - n * t), one, zero, -2 * (1 - c) / n, 4 * s / n - 3 * t, zero],
            [zero, zero, c, zero, zero, s / n],
            [3 * n * s, zero, zero, c, 2 * s, zero],
            [-6 * n * (1 - c), zero, zero, -2 * s, 4 * c - 3, zero],
            [zero, zero, -n * s, zero, zero, c],
        ]
    )


def generator(n: arb) -> arb_mat:
    """A of x' = A x."""
    a = arb_mat(6, 6)
    for k in range(3):
        a[k, 3 + k] = arb(1)
    a[3, 0], a[3, 4], a[4, 3], a[5, 2] = 3 * n * n, 2 * n, -2 * n, -n * n
    return a


def held(n: arb, t: arb) -> arb_mat:
    """Integral of transition(u) (0, I) over u in [0, t], (6, 3); t may be negative."""
    s, c = (n * t).sin(), (n * t).cos()
    square = n * n
    zero = arb(0)
    return arb_mat(
        [
            [(1 - c) / square, 2 * (t - s / n) / n, zero],
            [-2 * (t - s / n) / n, 4 * (1 - c) / square - 3 * t * t / 2, zero],
            [zero, zero, (1 - c) / square],
            [s / n, 2 * (1 - c) / n, zero],
            [-2 * (1 - c) / n, 4 * s / n - 3 * t, zero],
            [zero, zero, s / n],
        ]
    )


def column(entries: list[arb]) -> arb_mat:
    """A column vector."""
    return arb_mat([[entry] for entry in entries])


@dataclass
class Reached:
    """A centre (6, 1) and blocks, each a list of columns (6, 1)."""

    centre: arb_mat
    blocks: list[list[arb_mat]] = field(default_factory=list)

    def moved(self, matrix: arb_mat) -> Reached:
        """Its image."""
        return Reached(matrix * self.centre, [[matrix * m for m in block] for block in self.blocks])

    def grown(self, half: list[arb]) -> Reached:
        """With a box added."""
        blocks = list(self.blocks)
        for k, size in enumerate(half):
            if size == 0:
                continue
            blocks.append([column([size if j == k else arb(0) for j in range(6)])])
        return Reached(self.centre, blocks)


def shell(least: arb, greatest: arb, angle: arb) -> tuple[arb, arb, arb]:
    """A shell's piece, vectors of sizes [least, greatest] within an angle in [0, pi] of an axis: between which values
    along the axis (middle, half), and how far across it."""
    half_turn = arb.pi() / 2
    cosine = angle.cos()
    near = arb.min(least * cosine, greatest * cosine)
    across = greatest if angle >= half_turn else greatest * angle.sin() if angle < half_turn else greatest
    return (near + greatest) / 2, (greatest - near) / 2, across


def axes(v: list[arb]) -> tuple[list[arb], list[arb], list[arb], arb]:
    """Unit vectors along v and across it, and |v|."""
    size = sum((e * e for e in v), arb(0)).sqrt()
    along = [e / size for e in v]
    least = min(range(3), key=lambda k: abs(float(along[k].mid())))
    other = [arb(1 if k == least else 0) for k in range(3)]
    one = _cross(along, other)
    length = sum((e * e for e in one), arb(0)).sqrt()
    one = [e / length for e in one]
    return along, one, _cross(along, one), size


def _cross(a: list[arb], b: list[arb]) -> list[arb]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def speeds(v: list[arb]) -> arb_mat:
    """A velocity as a state."""
    return column([arb(0)] * 3 + v)


class Sets:
    """The sets of one statement."""

    def __init__(self, asked: Asked) -> None:
        self.asked, self.n = asked, arb(asked.n)
        self.share, self.angle = arb(asked.share), arb(asked.angle)
        self.before: list[Reached] = []
        self.after: list[Reached] = []
        planned = column([arb(e) for e in (asked.earth.before[0] if asked.earth else asked.start)])
        box = [arb(e) for e in asked.box]
        state = Reached(planned).grown(box)
        for k, impulse in enumerate(asked.impulses):
            if k:
                over = transition(self.n, arb(asked.times[k] - asked.times[k - 1]))
                if asked.earth is None:
                    planned = over * (planned + speeds([arb(e) for e in asked.impulses[k - 1]]))
                else:
                    planned = column([arb(e) for e in asked.earth.before[k]])
                state = Reached(planned).grown(box) if asked.anew else self.after[-1].moved(over)
            self.before.append(state)
            self.after.append(self._burnt(state, impulse, 1 - self.share, self.angle))

    def of(self, kind: str, burn: int, first: fmpq, last: fmpq) -> Reached:
        """The set of an event at the time of its burn."""
        if kind == "start":
            return self.before[0]
        before, impulse = self.before[burn], self.asked.impulses[burn]
        if kind == "made":
            return self.after[burn]
        if kind == "partial":
            return self._burnt(before, impulse, arb(0), self.angle)
        if kind == "misdirected":
            angle = arb.min(self.angle + arb(self.asked.misdirected), arb.pi())
            return self._burnt(before, impulse, 1 - self.share, angle)
        return (self._late if kind == "late" else self._stuck)(burn, impulse, first, last)

    def detour(self, event: Event) -> arb:
        """Bound on the distance between the actual position during a late or lasting burn and its equivalent state's:
        less than twice the path at its velocity, as |Phi_pv(t)| < 2 t for n t <= 1/2."""
        if event.kind not in ("late", "stuck"):
            return arb(0)
        last, most = arb(event.last), 1 + self.share
        if event.kind == "stuck":
            return 2 * last * last * most * arb(self.asked.acceleration)
        impulse = self.asked.impulses[event.burn]
        return 2 * last * most * sum((arb(e) ** 2 for e in impulse), arb(0)).sqrt()

    def _burnt(
        self, state: Reached, impulse: list[fmpq], least: arb, angle: arb, back: arb_mat | None = None
    ) -> Reached:
        """Add a burn with its errors as blocks, moved by ``back``."""
        along, one, two, size = axes([arb(e) for e in impulse])
        middle, half, across = shell(least, 1 + self.share, angle)

        def lifted(unit: list[arb], length: arb) -> arb_mat:
            added = speeds([length * size * e for e in unit])
            return added if back is None else back * added

        centre = state.centre + lifted(along, middle)
        return Reached(
            centre, [*state.blocks, [lifted(along, half)], [lifted(one, across), lifted(two, across)]]
        )

    def loose(self, size: arb) -> arb:
        """Largest length of the error of a thrust of this size."""
        _, half, across = shell(1 - self.share, 1 + self.share, self.angle)
        return size * (half * half + across * across).sqrt()

    def _rates(self, span: arb) -> list[arb]:
        """Greatest |d/dt Phi(-t) (0, e)| per unit of |e| in each of the six, over all t in the ball ``span``."""
        moving = generator(self.n) * transition(self.n, -span)
        return [sum((arb(moving[k, j].abs_upper()) ** 2 for j in (3, 4, 5)), arb(0)).sqrt() for k in range(6)]

    def _late(self, burn: int, impulse: list[fmpq], first: fmpq, last: fmpq) -> Reached:
        """Phi(-t) (0, v), t in [first, last]: value and tangent in the middle, a box for the second derivative."""
        middle, half = arb((first + last) / 2), arb((last - first) / 2)
        span = middle + arb(0, 1) * half
        back = transition(self.n, -middle)
        state = self._burnt(self.before[burn], impulse, 1 - self.share, self.angle, back)
        scale = shell(1 - self.share, 1 + self.share, self.angle)[0]
        v = speeds([scale * arb(e) for e in impulse])
        a = generator(self.n)
        state.blocks.append([half * (back * (a * v))])
        second = transition(self.n, -span) * (a * (a * v))
        size = sum((arb(e) ** 2 for e in impulse), arb(0)).sqrt()
        loose = self.loose(size)
        rates = self._rates(arb(0.5) * (1 + arb(0, 1)) * arb(last))
        return state.grown(
            [arb((half * half / 2 * second[k, 0]).abs_upper()) + half * loose * rates[k] for k in range(6)]
        )

    def _stuck(self, burn: int, impulse: list[fmpq], first: fmpq, last: fmpq) -> Reached:
        """int_0^s Phi(-t) (0, a) dt, s in [first, last], after the burn: value, tangent, bend; errors of the thrust."""
        middle, half = arb((first + last) / 2), arb((last - first) / 2)
        along, _, _, _ = axes([arb(e) for e in impulse])
        thrust = arb(self.asked.acceleration)
        scale = shell(1 - self.share, 1 + self.share, self.angle)[0]
        push = [scale * thrust * e for e in along]
        after = self.after[burn]
        state = Reached(after.centre - held(self.n, -middle) * column(push), list(after.blocks))
        state.blocks.append([half * (transition(self.n, -middle) * speeds(push))])
        end = arb(last)
        rates = self._rates(end / 2 + arb(0, 1) * end / 2)
        loose = self.loose(thrust)
        errors = [arb(0)] * 3 + [loose * end] * 3
        bend = half * half / 2 * scale * thrust
        return state.grown([errors[k] + (bend + loose * end * end) * rates[k] for k in range(6)])

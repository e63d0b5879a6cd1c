"""Checker of the hold after the end of `synchronize`, in ball arithmetic; docs/theory/hold.md has the inequalities.

With x_ref = Re(e^(i theta) X) at a node where the body is at angle theta, the error e = x - x_ref obeys e' = F e with
F = Phi + B K. The checker solves for X and its thrust c itself, shows P > 0 and P - F' P F > 0 by pivots, so that
{e' P e <= level} keeps itself, and bounds what all its errors take of thrust, faces and speed at every angle: a linear
image M e of the ellipsoid has |M e|^2 <= level lambda_max(M P^-1 M').
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

from flint import acb, acb_mat, arb, arb_mat

from safestart.proofs.balls import Motion
from safestart.proofs.hold.statement import FIELD, StatedHold
from safestart.proofs.strict import ProofRejected

_PIECES = 16

Faces = Mapping[str, tuple[list[arb], arb]]
"""Unit normals and offsets, m."""


@dataclass(frozen=True, slots=True)
class _At:
    """Bounds over ellipsoid and angles: distances left by face (m), distance from the target (m), LVLH speed (m/s)."""

    left: dict[str, arb]
    far: arb
    fast: arb


class Hold:
    """The loop of one claim, with thrust held over ``dt`` s; ``most`` m/s^2 bounds it, ``speed`` m/s the LVLH speed."""

    def __init__(
        self, claim: StatedHold, motion: Motion, dt: arb, faces: Faces, most: arb, speed: arb | None
    ) -> None:
        self.motion, self.dt, self.faces, self.most, self.speed = motion, dt, faces, most, speed
        self.gain, self.cost = (
            arb_mat([[arb(e) for e in row] for row in m]) for m in (claim.gain, claim.cost)
        )
        self.level, self.margin = arb(claim.level), arb(claim.margin)
        self.phi, self.held = motion.over(dt)
        self.state, self.thrust = self._reference(*map(arb, claim.point))
        _require_positive(self.cost, f"{FIELD}.cost: required positive definite")
        closed = self.phi + self.held * self.gain
        _require_positive(
            self.cost - closed.transpose() * self.cost * closed,
            f"{FIELD}.cost, gain: required that the cost falls with every step",
        )
        try:
            self.spread = self.cost.inv()
        except ZeroDivisionError:
            raise ProofRejected(f"{FIELD}.cost: required a matrix whose inverse can be enclosed") from None

    def check(self, end: arb_mat, time: arb) -> None:
        """Check thrust, faces and speed of the whole ellipsoid, and that it holds ``end`` (4, 1), at ``time`` s."""
        turn = _turn(self.motion.w * time)
        error = arb_mat(4, 1, [end[i, 0] - (turn * self.state[i, 0]).real for i in range(4)])
        cost = (error.transpose() * self.cost * error)[0, 0]
        if not cost <= self.level:
            raise ProofRejected(
                f"{FIELD}.level: required at least the error's cost at the end, {float(cost):.9g}, received "
                f"{float(self.level):.9g}"
            )
        needed = _largest(self.thrust[0, 0], self.thrust[1, 0]) + self._size(self.gain)
        if not needed <= self.most:
            raise ProofRejected(
                f"{FIELD}: the feedback may take {float(needed):.9g} m/s^2, a_max is {float(self.most):.9g}"
            )
        h = self.dt / _PIECES
        nodes = [self._bounds(h * j) for j in range(_PIECES + 1)]
        for j, (before, after) in enumerate(pairwise(nodes)):
            over = self._bounds(h * (2 * j + 1) / 2 + arb(0, 1) * h / 2)
            self._require(before, after, over, h)

    def _require(self, before: _At, after: _At, over: _At, h: arb) -> None:
        """Between two instants h apart a distance falls by at most h^2 / 8 of its second derivative below its chord."""
        n, w = self.motion.n, self.motion.w
        push = self.most + 3 * n * n * over.far + 2 * n * over.fast
        sag = h * h / 8 * (push + 2 * w * over.fast + w * w * over.far)
        for name in self.faces:
            for end in (before, after):
                if not end.left[name] - sag >= self.margin:
                    raise ProofRejected(
                        f"{FIELD}.margin_m: the distance to {name} may come down to "
                        f"{float(end.left[name] - sag):.9g} m, the claim is {float(self.margin):.9g} m"
                    )
        if self.speed is None:
            return
        for end in (before, after):
            fast = end.fast + h / 2 * push
            if not fast <= self.speed:
                raise ProofRejected(f"{FIELD}: the speed may reach {float(fast):.9g} m/s in LVLH")

    def _reference(self, x: arb, y: arb) -> tuple[acb_mat, acb_mat]:
        """Phasors of state (4, 1) and thrust (2, 1): (z - Phi) (P, V) = B c, P the point's, z a step's turn."""
        place = acb_mat(2, 1, [acb(x, y), acb(y, -x)])
        moved = acb_mat([[-acb(self.phi[i, j]) for j in range(4)] for i in range(4)])
        z = _turn(self.motion.w * self.dt)
        for i in range(4):
            moved[i, i] += z
        left = acb_mat(
            [[*(moved[i, j] for j in (2, 3)), *(acb(-self.held[i, j]) for j in (0, 1))] for i in range(4)]
        )
        right = acb_mat([[-moved[i, j] for j in (0, 1)] for i in range(4)]) * place
        try:
            found = left.solve(right)
        except ZeroDivisionError:
            raise ProofRejected(f"{FIELD}: no thrust held over the steps keeps the point") from None
        return (
            acb_mat(4, 1, [place[0, 0], place[1, 0], found[0, 0], found[1, 0]]),
            acb_mat(2, 1, [found[2, 0], found[3, 0]]),
        )

    def _bounds(self, s: arb) -> _At:
        """Bounds s seconds after a node, s a time or a span of times."""
        phi, held = self.motion.over(s)
        whole = phi + held * self.gain
        x = acb_mat(phi) * self.state + acb_mat(held) * self.thrust
        # x + i y = e^(i theta) (X + i Y) / 2 + e^(-i theta) conj(X - i Y) / 2, theta any angle.
        turning, other = (x[0, 0] + acb(0, 1) * x[1, 0]) / 2, (x[0, 0] - acb(0, 1) * x[1, 0]).abs_upper() / 2
        centre = _turn(-self.motion.w * s) * turning
        place, speed = (
            self._size(arb_mat([[whole[i, j] for j in range(4)] for i in rows])) for rows in ((0, 1), (2, 3))
        )
        left = {
            name: room - normal[0] * centre.real - normal[1] * centre.imag - other - place
            for name, (normal, room) in self.faces.items()
        }
        return _At(left, turning.abs_upper() + other + place, _largest(x[2, 0], x[3, 0]) + speed)

    def _size(self, rows: arb_mat) -> arb:
        """Largest |rows e|, rows (2, 4), over the ellipsoid."""
        m = rows * self.spread * rows.transpose()
        spread = acb(m[0, 0] - m[1, 1], 2 * m[0, 1]).abs_upper()
        return _root(self.level * (m[0, 0] + m[1, 1] + spread) / 2)


def _turn(angle: arb) -> acb:
    return acb(angle.cos(), angle.sin())


def _largest(x: acb, y: acb) -> arb:
    """Largest |Re(e^(i theta) (x, y))| over all theta."""
    sizes = sum((e.real * e.real + e.imag * e.imag for e in (x, y)), arb(0))
    return _root((sizes + (x * x + y * y).abs_upper()) / 2)


def _root(square: arb) -> arb:
    """Upper bound on the root of what is not negative, though its ball may reach below 0."""
    return square.abs_upper().sqrt()


def _require_positive(matrix: arb_mat, said: str) -> None:
    """All pivots of the symmetric matrix (4, 4) are above 0."""
    m = [[matrix[i, j] for j in range(4)] for i in range(4)]
    for k in range(4):
        if not m[k][k] > 0:
            raise ProofRejected(said)
        for i in range(k + 1, 4):
            share = m[i][k] / m[k][k]
            m[i] = [a - share * b for a, b in zip(m[i], m[k], strict=True)]

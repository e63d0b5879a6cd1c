"""The flight near which the sets of a burn are followed, and what all cases near it have in common.

Everything here is kept: transitions and paths at the times of cells, LVLH's axes, and for every number of parts the
transitions at their ends with the weights of the pushes in earlier parts.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from operator import add, mul

from flint import arb, arb_mat, fmpq

from safestart.proofs.abort.earth.course import Course, inverse
from safestart.proofs.abort.earth.pushes import LastingPushes, frame
from safestart.proofs.abort.earth.turning import Turning
from safestart.proofs.strict import ProofRejected


@dataclass(frozen=True, slots=True)
class Parts:
    """A drift in equal parts.

    ``curve``: K/8 times the square of their length; ``rows`` (3 (P + 1), 6): position rows of the transition at their
    ends; ``weights``: for each part the row (1, j) of what a push of 1 m/s^2 over each of the j parts before it can add
    to its positions, m; ``own``: the same of a push over the part itself.
    """

    curve: arb
    rows: arb_mat
    weights: list[arb_mat]
    own: arb


@dataclass(slots=True)
class Reference:
    """A reference from a burn on: its course, its inertial state relative to the target then (6, 1), exact; over the
    longest drift from that burn (``longest`` s) the least radius of its own and of both courses, m, a bound on |G|
    along both, 1/s^2, and on how LVLH turns."""

    target: Course
    course: Course
    off: arb_mat
    begin: fmpq
    longest: fmpq
    lowest: arb
    both: arb
    stiffness: arb
    turning: Turning
    lasting: LastingPushes | None = None
    _moved: dict[fmpq, arb_mat] = field(default_factory=dict)
    _paths: dict[fmpq, arb_mat] = field(default_factory=dict)
    _axes: dict[fmpq, arb_mat] = field(default_factory=dict)
    _parts: dict[int, Parts] = field(default_factory=dict)

    def moved(self, time: fmpq) -> arb_mat:
        """Position rows (3, 6) of the transition from the burn, ``time`` s long."""
        found = self._moved.get(time)
        if found is None:
            found = self._moved[time] = arb_mat(self.course.motion(arb(time)).tolist()[:3])
        return found

    def path(self, time: fmpq) -> arb_mat:
        """Position (3, 1) relative to the target, m, inertial."""
        found = self._paths.get(time)
        if found is None:
            away = self.target.state(arb(self.begin + time))[0]
            found = self._paths[time] = self.course.state(arb(time))[0] - away
        return found

    def axes(self, time: fmpq) -> arb_mat:
        """LVLH axes as columns (3, 3), inertial."""
        found = self._axes.get(time)
        if found is None:
            rows, _ = frame(self.target, arb(self.begin + time))
            found = self._axes[time] = rows.transpose()
        return found

    def parts(self, count: int) -> Parts:
        """The longest drift in ``count`` parts; raise ``ProofRejected`` where they are too long."""
        found = self._parts.get(count)
        if found is None:
            found = self._parts[count] = self._cut(count)
        return found

    def _cut(self, count: int) -> Parts:
        h, k = self.longest / count, self.stiffness.sqrt()
        step = arb(h)
        curve = self.stiffness * step * step / 8
        if not curve < 1:
            raise ProofRejected("radii_m: the parts are too long")
        moves = [self.course.motion(arb(h * j)) for j in range(count + 1)]
        grown, slid = (k * step).cosh(), (k * step).sinh() / k
        own = (grown - 1) / self.stiffness
        # What a push of part m adds to position and velocity at its end, carried to the end of part j - 1, within j.
        by_norm = grown * own, grown * slid, slid * own, slid * slid
        backs = [inverse(move).tolist() for move in moves[1:count]]
        beside: list[list[arb]] = [[] for _ in range(6)]
        weights = []
        for j in range(count):
            if j:
                for row, entries in zip(beside, backs[j - 1], strict=True):
                    row += entries
            weights.append(_carried(moves[j], beside, by_norm))
        rows = arb_mat([row for move in moves for row in move.tolist()[:3]])
        return Parts(curve, rows, weights, own)


def _carried(move: arb_mat, beside: list[list[arb]], by_norm: tuple[arb, arb, arb, arb]) -> arb_mat:
    """Weights (1, j): norms of the blocks of ``move`` times each of j inverses that lie beside each other (6, 6 j)."""
    if not beside[0]:
        return arb_mat(1, 0)
    squares = [list(map(mul, row, row)) for row in (move * arb_mat(beside)).tolist()]
    total = arb(0)
    out: list[arb] = [total] * (len(squares[0]) // 6)
    for half in (0, 1):
        below = list(map(add, map(add, squares[3 * half], squares[3 * half + 1]), squares[3 * half + 2]))
        sums = list(map(add, map(add, below[::3], below[1::3]), below[2::3]))
        for side in (0, 1):
            weight = by_norm[2 * half + side]
            out = [a + weight * arb(s.abs_upper()).sqrt() for a, s in zip(out, sums[side::2], strict=True)]
    return arb_mat(1, len(out), out)

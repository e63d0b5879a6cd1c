"""One step of the target's course and of the linear motion near it: a Taylor polynomial and a bound on its defect.

In scaled time r'' = g(r), F'' = G(r) F with g the gravity of a point mass and J2. Rounded coefficients make exact
polynomials p and F; their defects p'' - g(p) and F'' - G(p) F are bounded by their low coefficients, in ball
arithmetic, and by Cauchy's estimate of all others on a disc of complex times, where |p . p| has a positive lower bound.
"""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb, arb_mat

from safestart.proofs.abort.earth.polynomial import Polynomial
from safestart.proofs.abort.earth.pull import Field, Pull, Series, dot
from safestart.proofs.strict import ProofRejected

ORDER = 44
_SHARE = 0.25
"""Length of a step over the disc's radius."""
_BALLS = 64
"""Balls of time over a step for the least radius: with fewer the bound is coarser than what provers leave for it."""


@dataclass(frozen=True, slots=True)
class Step:
    """From scaled time ``begin`` on for ``length``: coefficients (ORDER + 1) of r (3, 1) and F (3, 6), bounds on both
    defects, on |F| with its derivative, least r . r, the low coefficients of r . r and a bound
    on what the others add."""

    begin: arb
    length: arb
    course: Polynomial
    motion: Polynomial
    course_defect: arb
    motion_defect: arb
    largest: arb
    square: arb
    squares: Series
    rest: arb

    def least(self, begin: arb, end: arb) -> arb:
        """Lower bound on p . p between two of its own scaled times after ``begin``."""
        return _lowest(self.squares, begin, end) - self.rest


def frobenius(matrix: arb_mat) -> arb:
    """Frobenius norm, from above."""
    entries = matrix.entries()
    return arb(dot(entries, entries).abs_upper()).sqrt()


def middle(matrix: arb_mat) -> arb_mat:
    """The middles of the balls, exact: radii are dropped."""
    return arb_mat(matrix.nrows(), matrix.ncols(), [e.mid() for e in matrix.entries()])


def step(field: Field, begin: arb, most: arb, start: tuple[arb_mat, arb_mat, arb_mat, arb_mat]) -> Step:
    """A step of at most ``most`` from exact r, r', F, F'; raise ``ProofRejected`` where the course is too bent."""
    r, f = [start[0], start[1]], [start[2], start[3]]
    series = Pull(field)
    loose_r, loose_f = [], []
    for k in range(ORDER - 1):
        pull, divide = series.extended(r), (k + 1) * (k + 2)
        r.append(middle(pull / divide))
        loose_r.append(frobenius(r[-1] * divide - pull))
    # The course does not depend on F: its gradients are known before F's coefficients are looked for.
    slopes = series.slopes()
    # All gradients beside each other, the latest first, and F's coefficients below each other: what belongs together
    # in a coefficient of their product is one product of matrices.
    beside: list[Series] = [[], [], []]
    for slope in reversed(slopes):
        for row, entries in zip(beside, slope.tolist(), strict=True):
            row += entries
    below = [e for m in f for e in m.entries()][:18]
    for k in range(ORDER - 1):
        first, divide = 3 * (ORDER - 2 - k), (k + 1) * (k + 2)
        flow = arb_mat([row[first:] for row in beside]) * arb_mat(3 * (k + 1), 6, below[: 18 * (k + 1)])
        f.append(middle(flow / divide))
        loose_f.append(frobenius(f[-1] * divide - flow))
        below += f[k + 1].entries()
    sizes_r, sizes_f = [frobenius(m) for m in r], [frobenius(m) for m in f]
    radius, square = _disc(sizes_r, series.square)
    length = arb((most.min(radius * _SHARE)).mid())
    size = _sum(sizes_r, radius)
    # Times that round to just outside the step belong to it, too.
    reach = length * (1 + arb(2) ** -20)
    tail = (reach / radius) ** (ORDER - 1) / (1 - reach / radius)
    reached, fast = _sum(sizes_f, reach), _sum([k * s for k, s in enumerate(sizes_f)][1:], reach)
    # Coefficients of p . p beyond the order, at twice the times.
    rest = _sum(sizes_r, 2 * reach) ** 2 / arb(2) ** (len(series.square) - 1)
    return Step(
        begin,
        length,
        Polynomial(r),
        Polynomial(f),
        _sum(loose_r, reach) + field.pull(size, square) * tail,
        _sum(loose_f, reach) + field.slope(size, square) * _sum(sizes_f, radius) * tail,
        (reached**2 + fast**2).sqrt(),
        _lowest(series.square, arb(0), reach) - rest,
        series.square,
        rest,
    )


def _sum(sizes: Series, radius: arb) -> arb:
    total = arb(0)
    for size in reversed(sizes):
        total = total * radius + arb(size.abs_upper())
    return total


def _least(sizes: Series, square: Series, radius: arb) -> arb:
    """Lower bound on |p . p| for |t| <= radius: the first coefficient less all others, those beyond the order by the
    square of the sum of sizes at twice the radius."""
    low = square[0]
    for k, s in enumerate(square[1:], 1):
        low = low - arb(abs(s).abs_upper()) * radius**k
    return low - _sum(sizes, 2 * radius) ** 2 / arb(2) ** (len(square) - 1)


def _lowest(square: Series, begin: arb, end: arb) -> arb:
    """Lower bound on the sum of the low coefficients of p . p over real times, by short balls of time."""
    low, half = arb("inf"), (end - begin) / (2 * _BALLS)
    for j in range(_BALLS):
        at, value = begin + half * (2 * j + 1 + arb(0, 1)), arb(0)
        for s in reversed(square):
            value = value * at + s
        low = low.min(arb(value.lower()))
    return low


def _disc(sizes: Series, square: Series) -> tuple[arb, arb]:
    radius = arb(1)
    for _ in range(40):
        low = _least(sizes, square, radius)
        if low > square[0] / 3:
            return radius, arb(low.abs_lower())
        radius = radius * 3 / 4
    raise ProofRejected("target: its course is too bent for a step")

"""One step of the target's course and of the linear motion near it: a Taylor polynomial and a bound on its defect.

In scaled time r'' = g(r), F'' = G(r) F with g the gravity of a point mass and J2. Rounded coefficients make exact
polynomials p and F; their defects p'' - g(p) and F'' - G(p) F are bounded by their low coefficients, in ball
arithmetic, and by Cauchy's estimate of all others on a disc of complex times, where |p . p| has a positive lower bound.
"""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb, arb_mat

from safestart.proofs.strict import ProofRejected

ORDER = 44
_SHARE = 0.25
"""Length of a step over the disc's radius."""
_BALLS = 64
"""Balls of time over a step for the least radius: with fewer the bound is coarser than what provers leave for it."""
Series = list[arb]


@dataclass(frozen=True, slots=True)
class Field:
    """Gravity in scaled time: mu and 3/2 mu J2 R^2, m^3 and m^5."""

    mu: arb
    bulge: arb

    def pull(self, size: arb, square: arb) -> arb:
        """Bound on |g| where |r| <= size and |r . r| >= square, also for complex r."""
        q = size * size / square
        return self.mu * size / square.sqrt() ** 3 + self.bulge * size / square.sqrt() ** 5 * (3 + 5 * q)

    def slope(self, size: arb, square: arb) -> arb:
        """Bound |G|, the gradient of g, where :meth:`pull` bounds |g|."""
        q = size * size / square
        return (
            self.mu * (1 + 3 * q) / square.sqrt() ** 3
            + self.bulge * (3 + 30 * q + 35 * q * q) / square.sqrt() ** 5
        )


@dataclass(frozen=True, slots=True)
class Step:
    """From scaled time ``begin`` on for ``length``: coefficients (ORDER + 1) of r (3, 1) and F (3, 6), bounds on both
    defects, on |F| with its derivative, least r . r, the low coefficients of r . r and a bound
    on what the others add."""

    begin: arb
    length: arb
    course: list[arb_mat]
    motion: list[arb_mat]
    course_defect: arb
    motion_defect: arb
    largest: arb
    square: arb
    squares: Series
    rest: arb

    def least(self, begin: arb, end: arb) -> arb:
        """Lower bound on p . p between two of its own scaled times after ``begin``."""
        return _lowest(self.squares, begin, end) - self.rest

    def at(self, coefficients: list[arb_mat], time: arb) -> tuple[arb_mat, arb_mat]:
        """Value and derivative at a scaled time after ``begin``."""
        value, rate = coefficients[-1], ORDER * coefficients[-1]
        for k in range(ORDER - 1, -1, -1):
            value = value * time + coefficients[k]
            if k:
                rate = rate * time + k * coefficients[k]
        return value, rate


def frobenius(matrix: arb_mat) -> arb:
    """Frobenius norm, from above."""
    total = sum((e * e for e in matrix.entries()), arb(0))
    return arb(total.abs_upper()).sqrt()


def middle(matrix: arb_mat) -> arb_mat:
    """The middles of the balls, exact: radii are dropped."""
    return arb_mat(matrix.nrows(), matrix.ncols(), [e.mid() for e in matrix.entries()])


def step(field: Field, begin: arb, most: arb, start: tuple[arb_mat, arb_mat, arb_mat, arb_mat]) -> Step:
    """A step of at most ``most`` from exact r, r', F, F'; raise ``ProofRejected`` where the course is too bent."""
    r, f = [start[0], start[1]], [start[2], start[3]]
    series = _Fields(field)
    loose_r, loose_f = [], []
    for k in range(ORDER - 1):
        pull, slope = series.extended(r)
        flow = arb_mat(3, 6)
        for j in range(k + 1):
            flow = flow + series.slopes[j] * f[k - j]
        divide = (k + 1) * (k + 2)
        r.append(middle(pull / divide))
        f.append(middle(flow / divide))
        loose_r.append(frobenius(r[-1] * divide - pull))
        loose_f.append(frobenius(f[-1] * divide - flow))
        del slope
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
        r,
        f,
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


class _Fields:
    """Series of g and G along a course, one coefficient after the other."""

    def __init__(self, field: Field) -> None:
        self.field = field
        self.square: Series = []
        self.powers: dict[int, Series] = {3: [], 5: [], 7: [], 9: []}
        self.zz: Series = []
        self.kept: dict[str, Series] = {name: [] for name in ("level", "alpha", "beta", "gamma", "bz")}
        self.radial: list[list[Series]] = []
        self.ax: list[Series] = [[], [], []]
        self.slopes: list[arb_mat] = []

    def extended(self, r: list[arb_mat]) -> tuple[arb_mat, arb_mat]:
        """Coefficients of g (3, 1) and G (3, 3) of the next order, from the course's up to it."""
        k = len(self.square)
        xs: list[Series] = [[m[i, 0] for m in r[: k + 1]] for i in range(3)]
        z = xs[2]
        self.square.append(sum((_product(x, x, k) for x in xs), arb(0)))
        self.zz.append(_product(z, z, k))
        for power, series in self.powers.items():
            series.append(self._power(power, k))
        mu, b, (a3, a5, a7, a9) = self.field.mu, self.field.bulge, (self.powers[p] for p in (3, 5, 7, 9))
        kept = self.kept
        kept["level"].append(-mu * a3[k] - b * (a5[k] - 5 * _product(self.zz, a7, k)))
        kept["alpha"].append(3 * mu * a5[k] + b * (5 * a7[k] - 35 * _product(self.zz, a9, k)))
        kept["beta"].append(10 * b * _product(z, a7, k))
        kept["gamma"].append(-2 * b * a5[k])
        for i in range(3):
            self.ax[i].append(_product(kept["alpha"], xs[i], k))
        pull = arb_mat(3, 1, [_product(kept["level"], xs[i], k) for i in range(3)])
        pull[2, 0] += _product(kept["gamma"], z, k)
        slope = arb_mat(3, 3)
        for i in range(3):
            for j in range(i, 3):
                slope[i, j] = _product(self.ax[i], xs[j], k)
                if j != i:
                    slope[j, i] = slope[i, j]
            slope[i, i] += kept["level"][k]
        for i in range(3):
            bent = _product(kept["beta"], xs[i], k)
            slope[i, 2] += bent
            slope[2, i] += bent
        slope[2, 2] += kept["gamma"][k]
        self.slopes.append(slope)
        return pull, slope

    def _power(self, power: int, k: int) -> arb:
        """Coefficient k of (r . r)^(-power/2): s f' = -(power/2) s' f."""
        s, f = self.square, self.powers[power]
        if k == 0:
            return 1 / s[0].sqrt() ** power
        total = arb(0)
        for j in range(1, k + 1):
            total += (-power * j - 2 * (k - j)) * s[j] * f[k - j]
        return total / (2 * k * s[0])


def _product(a: Series, b: Series, k: int) -> arb:
    """Coefficient k of a product."""
    return sum((a[j] * b[k - j] for j in range(k + 1)), arb(0))

"""Motion and sets in ball arithmetic: CWH matrices, centres with blocks of columns, pieces of shells.

States are (x, y, z, vx, vy, vz), LVLH. A set is a centre and blocks of columns M_k b_k, |b_k|_2 <= 1.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from operator import add, mul

from flint import arb, arb_mat, fmpq


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
        """The image of the set under ``matrix`` (6, 6)."""
        return Reached(matrix * self.centre, [[matrix * m for m in block] for block in self.blocks])

    def grown(self, half: list[arb]) -> Reached:
        """Add a box of half-widths ``half`` (6)."""
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


def sizes_of(image: arb_mat, counts: list[int]) -> list[arb]:
    """Sizes, from above, of the centre and of each block, from their images (3, 1 + C)."""
    out, at = [], 0
    for size in (1, *counts):
        total = sum((image[i, at + j] * image[i, at + j] for i in range(3) for j in range(size)), arb(0))
        out.append(arb(total.abs_upper()).sqrt())
        at += size
    return out


def sizes_along(images: arb_mat, counts: list[int]) -> list[list[arb]]:
    """:func:`sizes_of` at many times, from images (3 T, 1 + C) below each other."""
    rows, out = [list(map(mul, row, row)) for row in images.tolist()], []
    for k in range(0, len(rows), 3):
        squares, at, sizes = list(map(add, map(add, rows[k], rows[k + 1]), rows[k + 2])), 0, []
        for size in (1, *counts):
            sizes.append(arb(sum(squares[at : at + size], arb(0)).abs_upper()).sqrt())
            at += size
        out.append(sizes)
    return out


def level(values: arb_mat, counts: list[int]) -> arb:
    """f at one time."""
    low, at = values[0, 0], 1
    for size in counts:
        total = sum((values[0, at + j] * values[0, at + j] for j in range(size)), arb(0))
        low = low - arb(total.abs_upper()).sqrt()
        at += size
    return low


def reach(*parts: list[list[fmpq]]) -> arb:
    """Sum of the norms, from above, of parts that are lists of vectors (3,)."""
    squares = (arb(sum((e * e for v in part for e in v), fmpq(0))) for part in parts)
    return sum((arb(square.abs_upper()).sqrt() for square in squares), arb(0))

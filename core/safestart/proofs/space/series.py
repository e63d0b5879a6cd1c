"""Taylor series of polynomial differential equations in ball arithmetic, with the rest enclosed.

Time within a piece is x in [0, 1]. A series is a polynomial with ball coefficients that contains the function at every
x: what is cut off lies in the ball of its constant coefficient.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from flint import arb, arb_poly, fmpq

from safestart.proofs.strict import ProofRejected

Series = list[arb_poly]
_MOST_PIECES = 100_000


def picard(start: Sequence[arb], rates: Callable[[Series], Series], length: arb, order: int) -> Series:
    """Taylor polynomials of y' = rates(y), y = ``start`` at x = 0, over ``length`` s; every round gains an order."""
    found = [arb_poly([value]) for value in start]
    for k in range(1, order + 1):
        slopes = rates(found)
        found = [
            (length * slope.truncate(k)).integral() + value
            for slope, value in zip(slopes, start, strict=True)
        ]
    return found


def rest(size: arb, ratio: arb, order: int) -> arb:
    """A ball around 0 that holds sum_(k > order) c_k x^k, |x| <= 1, where |c_k| <= ``size`` ``ratio``^k."""
    if not ratio < arb(1) / 2:
        raise ProofRejected("a step in time is too long for its series")
    return arb(0, (2 * size * ratio ** (order + 1)).abs_upper())


def folded(series: arb_poly, order: int) -> arb_poly:
    """Take every term beyond ``order`` into the constant's ball."""
    if series.degree() <= order:
        return series
    over = sum((c.abs_upper() for c in series.coeffs()[order + 1 :]), arb(0))
    return series.truncate(order + 1) + arb(0, over.abs_upper())


def between(series: arb_poly, begin: arb, width: arb) -> arb_poly:
    """The series of x in begin + width [0, 1]."""
    return series(arb_poly([begin, width]))


def require_positive(
    series: arb_poly, name: str, begin: fmpq, length: fmpq, budget: list[int], less: Sequence[arb_poly] = ()
) -> None:
    """Prove that a series, less the sizes of those in ``less``, is >= 0 on [0, 1].

    Raises :class:`ProofRejected` where it is not, or not shown in time. ``budget`` holds the number of pieces that are
    left. Around the middle of a piece the Bernstein coefficients of the cubic bound it, and the sizes of the other
    coefficients what is left.
    """
    work = [(fmpq(1, 2), fmpq(1, 2))]
    while work:
        centre, half = work.pop()
        budget[0] -= 1
        here, sizes = between(series, arb(centre), arb(half)), arb(0)
        for each in less:
            part = between(each, arb(centre), arb(half))
            first, *others = [*part.coeffs(), arb(0)]
            over = sum((c.abs_upper() for c in others), arb(0))
            if abs(first) > over:
                here = here - part if first > 0 else here + part
            else:
                # It may change its sign here: at the middle its size counts, and over the piece what it grows by.
                here, sizes = here - first.abs_upper(), sizes + over
        a = here.coeffs()
        a0, a1, a2, a3 = [*a, *[arb(0)] * 4][:4]
        level = a0 - sizes - sum((c.abs_upper() for c in a[4:]), arb(0))
        if a0 < 0 or budget[0] < 0:
            at = begin + length * centre
            raise ProofRejected(
                f"{name} >= margin_m at t = {int(at.p) / int(at.q):.9g} s: short by {-float(a0):.9g} (m for a "
                "distance, m^2/s^2 for a speed)"
                + ("" if a0 < 0 else f", not settled after {_MOST_PIECES} pieces")
            )
        bends = (a2 - a1 - a3, a3 - (a1 + a2) / 3, (a1 - a2) / 3 - a3, a1 + a2 + a3)
        if not all(level + bend >= 0 for bend in bends):
            work += [(centre - half / 2, half / 2), (centre + half / 2, half / 2)]


def require_any(
    alternatives: Sequence[Series], name: str, begin: fmpq, length: fmpq, budget: list[int]
) -> None:
    """Prove that at every x in [0, 1] all series of one of the ``alternatives`` are >= 0.

    Pieces are halved until one alternative holds on all of a piece. Raises :class:`ProofRejected` where none does, or
    none is shown to in time.
    """
    work = [(fmpq(1, 2), fmpq(1, 2))]
    while work:
        centre, half = work.pop()
        budget[0] -= 1
        here = [[between(p, arb(centre), arb(half)) for p in each] for each in alternatives]
        if any(all(_positive(p) for p in each) for each in here):
            continue
        lost = all(any(p(arb(0)) < 0 for p in each) for each in here)
        if lost or budget[0] < 0:
            at = begin + length * centre
            short = "" if lost else f", not settled after {_MOST_PIECES} pieces"
            raise ProofRejected(f"{name} >= margin_m at t = {int(at.p) / int(at.q):.9g} s: it is not{short}")
        work += [(centre - half / 2, half / 2), (centre + half / 2, half / 2)]


def _positive(series: arb_poly) -> bool:
    """Whether the series is >= 0 for x in [-1, 1]: the first two terms bound it, and the sizes of the others."""
    a0, a1, *others = [*series.coeffs(), arb(0), arb(0)]
    level = a0 - sum((c.abs_upper() for c in others), arb(0))
    return bool(level - a1 >= 0 and level + a1 >= 0)


def fresh_budget() -> list[int]:
    """The number of pieces that one document may take."""
    return [_MOST_PIECES]


def pieces_of(budget: list[int]) -> int:
    """How many were used."""
    return _MOST_PIECES - budget[0]

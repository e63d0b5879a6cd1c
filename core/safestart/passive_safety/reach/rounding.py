"""One inflation for all round-off of double arithmetic in this package, and the proof that it is enough.

Lemma (running-error bound): a sum of products evaluated in doubles, in any order, with at most n roundings on the way
from an input to the result, is wrong by at most gamma_n times the sum of the absolute values of its terms, gamma_n =
n u / (1 - n u), u = 2^-53; underflow is out of reach (all magnitudes of interest are above 1e-200).

No set is propagated step by step. Every stage takes its input doubles as exact and adds its own inflation before the
next stage begins. The longest way of each stage, with g <= 24 generators of a tube and m <= 27 of a cell:

    node of a tube          entry of e^{At} 1, product 1, sum of four 3                                      5
    support of a node       product 1, sum of four 3, sum over g + 1 sets 25, noise 2                       31
    crossing                node 5, rates and falls 8, quotient 1, second order 6, projection 5, shift 2    27
    bin                     mean 2, half difference 2, chord 4, box 4                                       12
    cell                    node 5, mean 2, chord 4, box 5                                                  16
    clearance               normal 0 (plane) or 3 (space), products 3, sum over m + 3 sets 30, quotient 1   37

Each is below 38, so gamma is below 38 u = 2^-47.7: ``SLACK`` = 2^-46 = 128 u covers it three times, which is more than
the roundings of the inflation itself. The tests compare node, cell and clearance with exact arithmetic and find a
share of less than a tenth of the inflation used; the crossing they compare with a first-order projection only.
"""

from __future__ import annotations

SLACK = 2.0**-46
"""Relative inflation; multiplied by the sum of absolute values of the terms of an expression."""

UP = 1.0 + SLACK
"""Factor that rounds a non-negative bound upwards."""

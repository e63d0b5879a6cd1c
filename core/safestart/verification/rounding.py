"""One inflation for all round-off of double arithmetic in this package, and why it is enough.

A sum of products evaluated in doubles, in any order, with at most n roundings on the way from an input to the
result, is wrong by at most gamma_n times the sum of the absolute values of its terms, gamma_n = n u / (1 - n u) and
u = 2^-53 (the classical running-error bound). No set here is propagated step by step: every set at a time t is one
product of a matrix exponential, known to one rounding per entry (:mod:`safestart.verification.flow`), with the
initial centre and generators, so that n stays below 60. ``SLACK`` = 2^-46 = 128 u covers it twice.

Underflow is out of reach (all magnitudes of interest are above 1e-200).
"""

from __future__ import annotations

SLACK = 2.0**-46
"""Relative inflation; multiplied by the sum of absolute values of the terms of an expression."""

UP = 1.0 + SLACK
"""Factor that rounds a non-negative bound upwards."""

"""Matrix exponentials with proved error: tables of e^{At} on a uniform time grid, from ball arithmetic.

Entries are computed as balls of 200 bits (Arb, through python-flint) from the exact decimal matrix and rounded once,
so each double below is within one unit in the last place (and 1e-30) of the truth; errors do not grow with time.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import flint
import numpy as np

from safestart.model.scenario import Floats
from safestart.passive_safety.model import Motion, exact_matrix
from safestart.passive_safety.reach.rounding import UP
from safestart.runtime.precision import precise

_BITS = 200
_PIECES = 48
_CHUNK = 256
_WIDEST = 1e-30


@dataclass(frozen=True, slots=True)
class FlowTable:
    """e^{At} at t_k = start + k step (minutes): ``phi`` (n+1, 4, 4), ``psi`` = A^2 phi (n+1, 4, 4)."""

    start: float
    step: float
    phi: Floats
    psi: Floats


def _ball(value: Fraction) -> Any:
    return flint.arb(flint.fmpq(value.numerator, value.denominator))


def _balls(motion: Motion) -> Any:
    return flint.arb_mat([[_ball(entry) for entry in row] for row in exact_matrix(motion)])


def _doubles(balls: Any) -> list[float]:
    out = []
    for i in range(4):
        for j in range(4):
            entry = balls[i, j]
            if float(entry.rad()) > _WIDEST * (1.0 + abs(float(entry.mid()))):
                raise ArithmeticError("matrix exponential: the balls grew wider than 1e-30")
            out.append(float(entry.mid()))
    return out


@cache
def _nodes(motion: Motion, start: Fraction, step: Fraction, chunk: int) -> tuple[Floats, Floats]:
    """Chunk of ``_CHUNK`` nodes of phi and psi."""
    with precise(_BITS):
        a = _balls(motion)
        square = a * a
        one = (a * _ball(step)).exp()
        here = (a * _ball(start + step * chunk * _CHUNK)).exp()
        phi, psi = [], []
        for _ in range(_CHUNK):
            phi.append(_doubles(here))
            psi.append(_doubles(square * here))
            here = here * one
    return np.array(phi).reshape(-1, 4, 4), np.array(psi).reshape(-1, 4, 4)


@cache
def _table(motion: Motion, start: Fraction, step: Fraction, chunks: int) -> FlowTable:
    parts = [_nodes(motion, start, step, k) for k in range(chunks)]
    phi = np.concatenate([p for p, _ in parts])
    return FlowTable(float(start), float(step), phi, np.concatenate([q for _, q in parts]))


def flow_table(motion: Motion, start: Fraction, step: Fraction, steps: int) -> FlowTable:
    """Table of ``steps`` + 1 nodes; computed once per process in chunks of 256 nodes, then a view."""
    whole = _table(motion, start, step, steps // _CHUNK + 1)
    return FlowTable(whole.start, whole.step, whole.phi[: steps + 1], whole.psi[: steps + 1])


def flow_at(motion: Motion, time: float) -> tuple[Floats, Floats]:
    """phi and psi, each (4, 4), at one time (min), for exactly this double."""
    with precise(_BITS):
        a = _balls(motion)
        phi = (a * _ball(Fraction(time))).exp()
        return np.array(_doubles(phi)).reshape(4, 4), np.array(_doubles(a * a * phi)).reshape(4, 4)


@cache
def growth(motion: Motion, width: Fraction) -> Floats:
    """Entrywise bound (4, 4) on |e^{A s}| over 0 <= s <= ``width`` minutes: exponentials of 48 time balls."""
    with precise(_BITS):
        a, most = _balls(motion), np.zeros((4, 4))
        for k in range(_PIECES):
            middle = width * (2 * k + 1) / (2 * _PIECES)
            # Slightly wider than half a piece, so that the pieces overlap despite the rounding of the radius.
            radius = float(width) / (2 * _PIECES) * 1.001
            phi = (a * flint.arb(_ball(middle).mid(), radius)).exp()
            upper = [[float(phi[i, j].abs_upper()) for j in range(4)] for i in range(4)]
            most = np.maximum(most, np.array(upper))
    return most * UP

"""The same sets in any dimension: one linear program gives the point that goes furthest in a direction.

Open loop needs x(0) and the inputs. From outside, ``known`` disturbances: if one disturbance were known in advance,
feedback could do no better, so the program for any single one bounds the support of the feedback set.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_array, csr_array

from safestart.model.scenario import Floats
from safestart.sets.backward.question import Question


class Rows:
    """Sparse rows being collected."""

    def __init__(self) -> None:
        self._parts: list[tuple[Any, Any, Floats]] = []
        self._bounds: list[Floats] = []
        self.count = 0

    def add(self, blocks: Sequence[tuple[int, Any]], bound: Floats) -> None:
        """Rows: the sum over ``blocks`` of matrix @ variables from column ``first`` on, against ``bound``."""
        for first, matrix in blocks:
            row, column = np.nonzero(matrix)
            self._parts.append((row + self.count, column + first, matrix[row, column]))
        self._bounds.append(bound)
        self.count += len(bound)

    def matrix(self, columns: int) -> tuple[csr_array, Floats] | tuple[None, None]:
        """The collected rows and bounds."""
        if not self.count:
            return None, None
        rows, cols, values = (np.concatenate([part[k] for part in self._parts]) for k in range(3))
        return coo_array((values, (rows, cols)), shape=(self.count, columns)).tocsr(), np.concatenate(
            self._bounds
        )


@dataclass(frozen=True, slots=True)
class Program:
    """Constraints on (x(0), ..., x(N), c(0), ..., c(N-1), the rest); columns of x(0) come first."""

    size: int
    inputs: slice
    upper: tuple[csr_array, Floats] | tuple[None, None]
    equal: tuple[csr_array, Floats] | tuple[None, None]
    low: Floats
    high: Floats

    def furthest(
        self, direction: Floats, fixed: dict[int, float] | None = None
    ) -> tuple[Floats, Floats] | None:
        """x(0) (n,) that goes furthest in ``direction`` (n,), and its c (N m,); None: there is no such start.

        ``fixed`` holds components of x(0) at values. Raises ``ArithmeticError`` if the solver fails.
        """
        cost = np.zeros(len(self.low))
        cost[: self.size] = -direction
        low, high = self.low.copy(), self.high.copy()
        for index, value in (fixed or {}).items():
            if not low[index] <= value <= high[index]:
                return None
            low[index] = high[index] = value
        found: Any = linprog(  # type: ignore[call-overload]
            cost,
            A_ub=self.upper[0],
            b_ub=self.upper[1],
            A_eq=self.equal[0],
            b_eq=self.equal[1],
            bounds=np.stack([low, high], axis=1),
            method="highs",
        )
        if found.status == 2:
            return None
        if found.status != 0:
            raise ArithmeticError(f"the linear program ended with: {found.message}")
        return found.x[: self.size], found.x[self.inputs]


def open_loop(question: Question, shrunk: Floats, known: Floats | None = None) -> Program | None:
    """Boxes narrowed by ``shrunk`` (N + 1, n) a side, ``known`` (N, q) disturbances; None: a box is empty."""
    centres, halves = question.boxes()
    halves = halves - shrunk
    if (halves < 0.0).any():
        return None
    n, m, steps = len(question.a), len(question.inputs), question.steps
    width = (steps + 1) * n
    added = np.zeros((steps, n)) if known is None else known @ question.disturbance.T
    equal = Rows()
    for k in range(steps):
        equal.add(
            [(k * n, -question.a), ((k + 1) * n, np.eye(n)), (width + k * m, -question.b)],
            added[k],
        )
    low = np.concatenate([(centres - halves).ravel(), np.tile(-question.inputs, steps)])
    high = np.concatenate([(centres + halves).ravel(), np.tile(question.inputs, steps)])
    return Program(n, slice(width, width + steps * m), (None, None), equal.matrix(len(low)), low, high)

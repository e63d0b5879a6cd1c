"""Feedback in any dimension: the linear program over policies affine in the past disturbances (Goulart et al. 2006).

    u(k) = c(k) + sum over j < k of M(k, j) v(j)

P(k, j) is what v(j) adds to x(k): P(j+1, j) = E, P(k+1, j) = A P(k, j) + B M(k, j). All v with |v_i| <= 1 together
move a component by the sum of the absolute values of its row, so every limit on states and inputs is linear once each
absolute value has a variable above it. Affine policies are some of the possible ones: the set lies inside the
feedback set, and it holds the open-loop one (M = 0).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from safestart.model.scenario import Floats
from safestart.sets.backward.program import Program, Rows
from safestart.sets.backward.question import Question


def affine(question: Question, disturbance: Floats) -> Program:
    """The program for W = {E v}, E = ``disturbance`` (n, q); about N^2 q (n + m) variables."""
    n, m, q, steps = len(question.a), len(question.inputs), disturbance.shape[1], question.steps
    centres, halves = question.boxes()
    plan = (steps + 1) * n
    columns = plan + steps * m
    equal, upper = Rows(), Rows()
    free: list[tuple[int, int]] = []

    def variables(count: int, nonnegative: bool = False) -> int:
        nonlocal columns
        free.append((count, int(nonnegative)))
        columns += count
        return columns - count

    for k in range(steps):
        now, after = k * n, (k + 1) * n
        equal.add([(now, -question.a), (after, np.eye(n)), (plan + k * m, -question.b)], np.zeros(n))
    answers = {(k, j): variables(m * q) for k in range(steps) for j in range(k)}
    moved = {(k, j): variables(n * q) for k in range(1, steps + 1) for j in range(k)}
    for (k, j), first in moved.items():
        blocks: list[tuple[int, Any]] = [(first, np.eye(n * q))]
        constant = disturbance.ravel()
        if k > j + 1:
            # Blocks are stored row by row: the product with A acts as the Kronecker product of A with the identity.
            blocks.append((moved[k - 1, j], np.kron(-question.a, np.eye(q))))
            blocks.append((answers[k - 1, j], np.kron(-question.b, np.eye(q))))
            constant = np.zeros(n * q)
        equal.add(blocks, constant)

    def sizes(first: int, count: int) -> int:
        """Variables at least as large as the absolute values of ``count`` variables from ``first`` on."""
        above = variables(count, nonnegative=True)
        one = np.eye(count)
        upper.add([(first, one), (above, -one)], np.zeros(count))
        upper.add([(first, -one), (above, -one)], np.zeros(count))
        return above

    def limit(first: int, rows: Floats, parts: list[int], centre: Floats, half: Floats) -> None:
        """|variables of ``rows`` - centre| + row sums of the ``parts``, each (size, q), at most half."""
        sums = np.kron(rows, np.ones((1, q)))
        around: list[tuple[int, Any]] = [(part, sums) for part in parts]
        upper.add([(first, rows), *around], half + centre)
        upper.add([(first, -rows), *around], half - centre)

    for k in range(1, steps + 1):
        rows = np.eye(n)[np.isfinite(halves[k])]
        if len(rows):
            parts = [sizes(moved[k, j], n * q) for j in range(k)]
            limit(k * n, rows, parts, rows @ centres[k], halves[k][np.isfinite(halves[k])])
    for k in range(1, steps):
        parts = [sizes(answers[k, j], m * q) for j in range(k)]
        limit(plan + k * m, np.eye(m), parts, np.zeros(m), question.inputs)
    low, high = np.full(columns, -np.inf), np.full(columns, np.inf)
    low[:n], high[:n] = centres[0] - halves[0], centres[0] + halves[0]
    low[plan : plan + m], high[plan : plan + m] = -question.inputs, question.inputs
    begin = plan + steps * m
    for count, nonnegative in free:
        if nonnegative:
            low[begin : begin + count] = 0.0
        begin += count
    return Program(n, slice(plan, plan + steps * m), upper.matrix(columns), equal.matrix(columns), low, high)

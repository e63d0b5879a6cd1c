"""Backward reachable sets of planar systems as polygons, by recursion over the steps; exact to rounding.

Open loop: the inputs are fixed before the first disturbance. Feedback: each input knows the state. With
Q = {-B u : |u_i| <= inputs_i}, W = {E v : |v_i| <= 1} and the boxes X(k) of the question:

    open loop   S(N) = X(N) shrunk,                 S(k) = A^-1 (S(k+1) + Q) and X(k) shrunk
    feedback    S(N) = X(N),                        S(k) = A^-1 ((S(k+1) - W) + Q) and X(k)

where "shrunk" takes the half-width of all that the disturbance adds up to step k off each side, and "- W" is the
Pontryagin difference (Bertsekas and Rhodes 1971). The first lies in the second.
"""

from __future__ import annotations

import numpy as np

from safestart.model.scenario import Floats
from safestart.sets.backward.polygon import box, hull, minus, plus, within
from safestart.sets.backward.question import Question


def open_loop(question: Question, shrunk: Floats) -> list[Floats | None]:
    """S(0) .. S(N) with the boxes narrowed by ``shrunk`` (N + 1, 2) a side; zeros give the nominal set."""
    centres, halves = question.boxes()
    halves = halves - shrunk
    return _back(question, box(centres[-1], halves[-1]), np.zeros((2, 0)), halves)


def feedback(question: Question, disturbance: Floats) -> list[Floats | None]:
    """S(0) .. S(N) against W = {E v : |v_i| <= 1}, E = ``disturbance`` (2, q), inputs chosen as the state is known."""
    centres, halves = question.boxes()
    return _back(question, box(centres[-1], halves[-1]), disturbance, halves)


def _back(
    question: Question, target: Floats | None, disturbance: Floats, halves: Floats
) -> list[Floats | None]:
    inverse = np.linalg.inv(question.a)
    generators = question.b * question.inputs
    found: list[Floats | None] = [target]
    for k in range(question.steps - 1, -1, -1):
        last = found[-1]
        safe = None if last is None else minus(last, disturbance)
        if safe is None or (halves[k] < 0.0).any():
            found.append(None)
            continue
        found.append(within(hull(plus(safe, generators) @ inverse.T), halves[k]))
    return found[::-1]

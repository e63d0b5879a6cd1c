"""Compile the kernels of the exact answers, or load them from Numba's cache."""

from __future__ import annotations

import numpy as np

from safestart.exact.decide import decide
from safestart.exact.question import Question
from safestart.model.scenario import Scenario


def warm() -> None:
    """Answer a small question in the plane and one in space; their kernels are those of all questions."""
    scenario = Scenario.of(3.0, 0.1)
    decide(Question(scenario, steps=4), np.array([5.0, 40.0, 0.0, 0.0]))
    decide(Question(scenario, steps=4, dimensions=3), np.array([5.0, 40.0, 2.0, 0.0, 0.0, 0.0]))

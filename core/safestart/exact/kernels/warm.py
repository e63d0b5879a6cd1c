"""Compile the kernels of the exact answers, or load them from Numba's cache."""

from __future__ import annotations

import numpy as np

from safestart.exact.decide import decide
from safestart.exact.question import Question
from safestart.exact.watch import watch_of
from safestart.model.scenario import Scenario
from safestart.optim.largest_margin import solve


def warm() -> None:
    """Answer a small question in the plane and one in space, then take the steps that Python takes by itself.

    Small questions end in one compiled call; regions, disturbances and families call its parts one by one.
    """
    scenario = Scenario.of(3.0, 0.1)
    question, start = Question(scenario, steps=4), np.array([5.0, 40.0, 0.0, 0.0])
    decide(question, start)
    decide(Question(scenario, steps=4, dimensions=3), np.array([5.0, 40.0, 2.0, 0.0, 0.0, 0.0]))
    found = watch_of(question).minima(start, np.zeros((question.steps, question.dimensions)))
    cuts = watch_of(question).cuts(found.times, found.faces)
    room = cuts.offset + cuts.start @ start
    solve(room, cuts.thrust, scenario.chaser.max_acceleration, question.dimensions)

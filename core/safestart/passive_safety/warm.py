"""Compile the kernels of the reach tubes and of the simulated flights, or load them from Numba's cache."""

from __future__ import annotations

import numpy as np

from safestart.passive_safety.cases import HORIZON
from safestart.passive_safety.flights.rk8_flights import simulate
from safestart.passive_safety.model import PUBLISHED, System
from safestart.passive_safety.question import Question
from safestart.passive_safety.verify import verify


def warm(system: System = PUBLISHED) -> None:
    """Call each kernel once; also computes the tables of matrix exponentials, which depend only on the system."""
    verify(Question(window=(0.0, HORIZON), box=50.0, system=system))
    simulate(system, np.array([[-900.0, -400.0, 0.0, 0.0]]), np.array([np.inf]), np.array([[1.0]]))

"""Compile the kernels of the reach tubes and of the simulated flights, or load them from Numba's cache."""

from __future__ import annotations

import numpy as np

from safestart.verification.cases import HORIZON
from safestart.verification.flights import simulate
from safestart.verification.model import PUBLISHED, System
from safestart.verification.question import Question
from safestart.verification.verify import verify


def warm(system: System = PUBLISHED) -> None:
    """Ask each kernel once; computes the tables of matrix exponentials, too, which depend on the system alone."""
    verify(Question(window=(0.0, HORIZON), box=50.0, system=system))
    simulate(system, np.array([[-900.0, -400.0, 0.0, 0.0]]), np.array([np.inf]), np.array([[1.0]]))

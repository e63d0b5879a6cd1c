"""Compile the kernels of the avoid game, or load them from Numba's cache."""

from __future__ import annotations

import numpy as np

from safestart.avoidance.capture import arrival_times
from safestart.avoidance.certified import lower, upper
from safestart.avoidance.feedback import RECOVERY, Slot
from safestart.avoidance.game import Game
from safestart.avoidance.inputs import InputSet


def warm() -> None:
    """Ask each kernel once."""
    game = Game(0.0011, InputSet("box", (0.1, 0.1)), InputSet("box", (0.05, 0.05)), 100.0)
    start = np.array([[200.0, 0.0, -4.0, 0.0]])
    upper(game, start, 10.0)
    lower(game, start, 10.0, effort=1)
    arrival_times(game, Slot(), RECOVERY, start, 1.0)

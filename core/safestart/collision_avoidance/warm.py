"""Compile the kernels of the avoid game, or load them from Numba's cache."""

from __future__ import annotations

import numpy as np

from safestart.collision_avoidance.bounds.certified import lower, upper
from safestart.collision_avoidance.capture import arrival_times
from safestart.collision_avoidance.encounters.slot import RECOVERY, Slot
from safestart.collision_avoidance.game import Game
from safestart.constraints.thrust import InputSet


def warm() -> None:
    """Call each kernel once."""
    game = Game(0.0011, InputSet("box", (0.1, 0.1)), InputSet("box", (0.05, 0.05)), 100.0)
    start = np.array([[200.0, 0.0, -4.0, 0.0]])
    upper(game, start, 10.0)
    lower(game, start, 10.0, effort=1)
    arrival_times(game, Slot(), RECOVERY, start, 1.0)

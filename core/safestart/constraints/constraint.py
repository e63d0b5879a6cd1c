"""The interface of every constraint on a flight, which must hold at all times."""

from __future__ import annotations

from typing import Protocol

from safestart.attitude.attitude import Attitude
from safestart.model.scenario import Floats


class Constraint(Protocol):
    """A set of distances that must not be negative."""

    @property
    def names(self) -> tuple[str, ...]:
        """One name per distance (F)."""
        ...

    def room(self, times: Floats, states: Floats, attitude: Attitude) -> tuple[Floats, Floats]:
        """Distances (T, F), m, of LVLH states (T, 6) at ``times`` (T,), negative outside, and their rates (T, F), m/s.

        The watch joins both to a cubic between two times, so the distances must be smooth in time.
        """
        ...

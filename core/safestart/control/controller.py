"""From a state to a command: the interface that every controller offers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from safestart.model.scenario import Floats


@dataclass(frozen=True, slots=True)
class Command:
    """A controller's command for one interval, in LVLH axes.

    ``thrust`` (3,), m/s^2, is held over the interval; ``impulse`` (3,), m/s, changes the velocity at its start.
    ``feasible``: False when the controller found no admissible command and this is its best. ``label`` names its regime
    or mode. A controller with more to report derives its own command class.
    """

    thrust: Floats
    feasible: bool = True
    label: str = ""
    impulse: Floats | None = None


class Controller(Protocol):
    """State in, command out. A controller may remember the past, and changes nothing else."""

    def begin(self, state: Floats) -> None:
        """A new flight starts at the LVLH state (6,): forget the last flight."""
        ...

    def command(self, k: int, state: Floats) -> Command:
        """The command for interval ``k`` from navigation's LVLH state (6,), m and m/s."""
        ...

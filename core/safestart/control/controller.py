"""From a state to a command: the interface that every controller offers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from safestart.model.scenario import Floats


@dataclass(frozen=True, slots=True)
class Command:
    """What a controller asks for in one interval, in LVLH axes.

    ``thrust`` (3,), m/s^2, is held over the interval; ``impulse`` (3,), m/s, changes the velocity at its start.
    ``feasible``: False where the controller found no admissible command and this is its best. ``label`` says what it
    was doing (a regime, a mode). A controller with more to tell derives its own command.
    """

    thrust: Floats
    feasible: bool = True
    label: str = ""
    impulse: Floats | None = None


class Controller(Protocol):
    """State in, command out. A controller keeps what it needs of the past and changes nothing else."""

    def begin(self, state: Floats) -> None:
        """A new flight starts at the LVLH state (6,): what was kept of the last one is forgotten."""
        ...

    def command(self, k: int, state: Floats) -> Command:
        """The command for interval ``k`` from the LVLH state (6,), m and m/s, as navigation has it."""
        ...

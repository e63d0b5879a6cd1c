"""The plant of a scenario: how the chaser moves and how the target turns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from safestart.attitude.attitude import Attitude
from safestart.attitude.spin import spin_of
from safestart.dynamics.motion import Motion
from safestart.dynamics.registry import CWH, MOTIONS
from safestart.errors import invalid
from safestart.model.scenario import Scenario, Target

ATTITUDES: dict[str, Callable[[Target], Attitude]] = {"spin": spin_of}
"""The attitudes of a scenario's target, by name."""


@dataclass(frozen=True, slots=True)
class Plant:
    """A motion and an attitude, independent of each other."""

    motion: Motion
    attitude: Attitude


def plant_of(scenario: Scenario, motion: str = CWH, attitude: str = "spin") -> Plant:
    """The plant of a scenario; raises ``InvalidInput`` for an unknown motion or attitude."""
    if not isinstance(motion, str) or motion not in MOTIONS:
        raise invalid("motion", f"one of {', '.join(MOTIONS)}", motion)
    if not isinstance(attitude, str) or attitude not in ATTITUDES:
        raise invalid("attitude", f"one of {', '.join(ATTITUDES)}", attitude)
    return Plant(MOTIONS[motion].of(scenario.target), ATTITUDES[attitude](scenario.target))

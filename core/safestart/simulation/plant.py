"""The plant: how the chaser moves and how the target turns, as one scenario has them."""

from __future__ import annotations

from dataclasses import dataclass

from safestart.attitude.attitude import Attitude
from safestart.attitude.spin import spin_of
from safestart.dynamics.cwh import Cwh
from safestart.dynamics.motion import Motion
from safestart.dynamics.two_body import Orbit, TwoBody
from safestart.errors import invalid
from safestart.model.scenario import Scenario

MODELS = ("cwh", "two_body_j2")
"""Names of the motions that :func:`plant_of` can put under a scenario."""


@dataclass(frozen=True, slots=True)
class Plant:
    """A motion and an attitude; neither knows the other."""

    motion: Motion
    attitude: Attitude


def plant_of(scenario: Scenario, model: str = "cwh") -> Plant:
    """The plant of a scenario; raises ``InvalidInput`` for another model than one of ``MODELS``."""
    target = scenario.target
    if model == "cwh":
        return Plant(Cwh(target.mean_motion), spin_of(target))
    if model == "two_body_j2":
        return Plant(TwoBody(Orbit.of(target.mean_motion)), spin_of(target))
    raise invalid("model", f"one of {', '.join(MODELS)}", model)

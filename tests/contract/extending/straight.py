"""An example motion: straight lines, as far from every mass."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.dynamics.motion import RelativeMotion
from safestart.model.scenario import Floats, Target


@dataclass(frozen=True)
class Straight(RelativeMotion):
    """No gravity at all."""

    def transition(self, t0: float, t1: float) -> Floats:
        """The velocity moves the position."""
        phi = np.eye(6)
        phi[:3, 3:] = (t1 - t0) * np.eye(3)
        return phi

    def held(self, t0: float, t1: float) -> Floats:
        """A constant acceleration."""
        tau = t1 - t0
        return np.concatenate([0.5 * tau * tau * np.eye(3), tau * np.eye(3)])


def straight_of(_: Target) -> Straight:
    """The same near every target."""
    return Straight()

"""Saturated PD feedback to a fixed point in LVLH (paper 001, eqs. 8 and 9)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.constraints.thrust import InputSet
from safestart.control.controller import Command
from safestart.errors import invalid
from safestart.model.scenario import Floats, number


@dataclass(frozen=True, slots=True)
class PdGains:
    """Gains by channel: ``position`` in 1/s^2, ``speed`` in 1/s. Raises ``InvalidInput``."""

    position: tuple[float, ...]
    speed: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.position) != len(self.speed):
            raise invalid("speed", f"{len(self.position)} numbers, as position has", self.speed)
        for k in range(len(self.position)):
            number(f"position[{k}]", self.position[k], 0.0, 1.0)
            number(f"speed[{k}]", self.speed[k], 0.0, 1.0)


def pd_thrust(states: Floats, centre: Floats, gains: PdGains, limits: InputSet) -> Floats:
    """u (..., m) in m/s^2 at states (..., 2 m) towards ``centre`` (2 m,), cut off at the limits.

    States hold positions, then speeds, in the order of the channels, for any axes.
    """
    off = states - centre
    m = limits.channels
    demand = -np.array(gains.position) * off[..., :m] - np.array(gains.speed) * off[..., m:]
    return limits.cut(demand)


class Pd:
    """The law as a controller, for one state or many; ``axes`` are the LVLH axes (0, 1, 2) of the channels."""

    def __init__(
        self, axes: tuple[int, ...], centre: tuple[float, ...], gains: PdGains, limits: InputSet
    ) -> None:
        self._axes, self._centre = list(axes), np.array(centre)
        self._gains, self._limits = gains, limits

    def begin(self, state: Floats) -> None:
        """Nothing to forget."""

    def command(self, k: int, state: Floats) -> Command:  # noqa: ARG002
        """See :class:`safestart.control.controller.Controller`."""
        seen = state[..., [*self._axes, *(axis + 3 for axis in self._axes)]]
        thrust = np.zeros((*state.shape[:-1], 3))
        thrust[..., self._axes] = pd_thrust(seen, self._centre, self._gains, self._limits)
        return Command(thrust)

"""Starts of flights: states of chasers at rest, and the number of control intervals of a time."""

from __future__ import annotations

import math

import numpy as np

from safestart.attitude.body_frame import transport
from safestart.errors import invalid
from safestart.model.scenario import Floats, Rest, Scenario


def start_states(scenario: Scenario, positions: Floats, rest: Rest) -> Floats:
    """LVLH states (M, 6) of chasers at rest in LVLH or in the body frame at ``positions`` (M, 2 or 3), metres.

    At t = 0 the frames coincide; a chaser at rest in the body frame moves with omega x r (eq. 5).
    """
    positions = np.asarray(positions, dtype=np.float64)
    if positions.ndim != 2 or positions.shape[1] not in (2, 3):
        raise invalid("positions", "an array of shape (M, 2) or (M, 3), metres", positions.shape)
    states = np.zeros((len(positions), 6))
    states[:, : positions.shape[1]] = positions
    if rest is Rest.BODY:
        states[:, 3:] = transport(states[:, :3], scenario.target.tumble_rate)
    return states


def steps_of(t_sim: float, dt: float) -> int:
    """Number of control steps that cover ``t_sim`` seconds: the flight ends at the first node at or after it.

    Raises ``InvalidInput`` unless both are positive and finite.
    """
    for name, value in (("t_sim", t_sim), ("dt", dt)):
        if not (math.isfinite(value) and value > 0.0):
            raise invalid(name, "a time of more than 0 s", value)
    return max(1, math.ceil(t_sim / dt - 1e-9))

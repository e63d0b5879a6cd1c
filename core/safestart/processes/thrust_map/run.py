"""Run thrust-map: one certificate map per pair, one bisection per tumble rate."""

from __future__ import annotations

import math

import numpy as np

from safestart.closed_form.paper import certify, certify_grid
from safestart.model.scenario import MAX_ACCELERATION, MIN_ACCELERATION, Chaser, Grid, Scenario, Target
from safestart.processes.base import ProcessOutput
from safestart.processes.thrust_map.spec import ThrustMapInputs
from safestart.runtime.progress import Context

_CELLS = 61


def run(inputs: ThrustMapInputs, context: Context) -> ProcessOutput:
    """Evaluate every pair and bisect every rate."""
    grid = Grid(_CELLS, _CELLS, inputs.y_max_m)
    share, required = [], []
    for k, rate in enumerate(inputs.omega_t_deg_s):
        share.append(
            [
                100.0 * certify_grid(_scenario(inputs, rate, thrust), grid, inputs.rest).safe_fraction
                for thrust in inputs.a_max_m_s2
            ]
        )
        required.append(_required(inputs, rate))
        context.step(k + 1, len(inputs.omega_t_deg_s), f"{rate:g} deg/s")
    return ProcessOutput(
        {
            "omega_t_deg_s": inputs.omega_t_deg_s,
            "a_max_m_s2": inputs.a_max_m_s2,
            "safe_percent": share,
            "required_a_max_m_s2": required,
        }
    )


def _scenario(inputs: ThrustMapInputs, rate: float, thrust: float) -> Scenario:
    target = Target(math.radians(rate), inputs.mean_motion_rad_s)
    return Scenario(target, Chaser(thrust), inputs.corridor.shape())


def _required(inputs: ThrustMapInputs, rate: float) -> float | None:
    """Bisection on the logarithm: more thrust never takes a certificate away."""
    start = np.array([[0.0, inputs.stand_off_m]])

    def certified(thrust: float) -> bool:
        return bool(certify(_scenario(inputs, rate, thrust), start, inputs.rest).safe[0])

    low, high = MIN_ACCELERATION, MAX_ACCELERATION
    if not certified(high):
        return None
    if certified(low):
        return low
    while high / low > 1.0 + 1e-6:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if certified(middle) else (middle, high)
    return high

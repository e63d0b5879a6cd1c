"""Run drift: the state-transition matrix at every step."""

# ruff: noqa: I001 - the package that it belongs to is another one here

from __future__ import annotations

import numpy as np

from safestart.dynamics.cwh import transition_matrix
from safestart.processes.base import ProcessOutput
from safestart.processes.drift.spec import DriftInputs
from safestart.processes.wire import DT_S
from safestart.runtime.progress import Context


def run(inputs: DriftInputs, context: Context) -> ProcessOutput:
    """Carry the state from step to step."""
    steps = round(inputs.horizon_s / DT_S)
    step = transition_matrix(inputs.mean_motion_rad_s, DT_S)
    states = [np.array([*inputs.position_m, *inputs.velocity_m_s])]
    for k in range(steps):
        states.append(step @ states[-1])
        context.step(k + 1, steps)
    positions = np.array(states)[:, :3]
    distance = np.linalg.norm(positions, axis=1)
    closest = int(distance.argmin())
    return ProcessOutput(
        {
            "time_s": (DT_S * np.arange(steps + 1)).tolist(),
            "position_m": positions.tolist(),
            "closest_m": float(distance[closest]),
            "closest_s": DT_S * closest,
        }
    )

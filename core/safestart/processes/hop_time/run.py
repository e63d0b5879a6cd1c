"""Run hop-time: one root, and the path of that hop."""

from __future__ import annotations

import math

import numpy as np

from safestart.dynamics.cwh import position_matrices
from safestart.hopping.approach import departure, line
from safestart.hopping.hop_time import hop_time
from safestart.processes.base import ProcessOutput
from safestart.processes.hop_time.spec import HopTimeInputs
from safestart.runtime.progress import Context

_POINTS = 121


def run(inputs: HopTimeInputs, context: Context) -> ProcessOutput:
    """Solve; the path of a drift has no scale of length, and with mean motion 1 its time is a phase."""
    orbits, fold = hop_time(inputs.angle_deg, inputs.rho)
    phase = orbits * math.tau
    begin = line(inputs.angle_deg)
    velocity = departure(1.0, phase, begin, inputs.rho * begin)
    free, _ = position_matrices(1.0, np.linspace(0.0, phase, _POINTS), 2)
    path = free @ np.concatenate([begin[:2], velocity[:2]])
    context.step(1, 1)
    return ProcessOutput({"orbits": orbits, "fold_deg": fold, "path": path.tolist()})

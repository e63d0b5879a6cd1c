"""Run hop-time: one root."""

from __future__ import annotations

from safestart.hopping.hop_time import hop_time
from safestart.processes.base import ProcessOutput
from safestart.processes.hop_time.spec import HopTimeInputs
from safestart.runtime.progress import Context


def run(inputs: HopTimeInputs, context: Context) -> ProcessOutput:
    """Solve."""
    orbits, fold = hop_time(inputs.angle_deg, inputs.rho)
    context.step(1, 1)
    return ProcessOutput({"orbits": orbits, "fold_deg": fold})

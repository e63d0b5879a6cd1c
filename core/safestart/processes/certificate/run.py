"""Run certificate: one vectorised pass over the grid."""

from __future__ import annotations

import math
from typing import Any

from safestart.closed_form.paper import certify_grid
from safestart.processes.base import ProcessOutput
from safestart.processes.benchmark.spec import BenchmarkQuestion
from safestart.processes.certificate.spec import CertificateInputs
from safestart.processes.wire import NO_SYNC_LIMIT, finite
from safestart.runtime.progress import Context


def answer(inputs: CertificateInputs | BenchmarkQuestion) -> dict[str, Any]:
    """The certificate document of an operating point and a grid."""
    scenario, grid = inputs.scenario(), inputs.grid.grid()
    region = certify_grid(scenario, grid, inputs.rest)
    x, y = grid.axes(scenario.corridor)
    limit = region.range_limit
    return {
        "r_sync_m": finite(limit),
        "r_sync_reason": None if math.isfinite(limit) else NO_SYNC_LIMIT,
        "safe_fraction": region.safe_fraction,
        "x_m": x.tolist(),
        "y_m": y.tolist(),
        "mask": region.mask.tolist(),
        "margin_m": region.margin.tolist(),
    }


def run(inputs: CertificateInputs, context: Context) -> ProcessOutput:
    """Certify the grid."""
    document = answer(inputs)
    context.step(1, 1)
    return ProcessOutput(document)

"""Run certificate: one vectorised pass over the grid."""

from __future__ import annotations

import math
from typing import Any

from safestart.closed_form.by_name import ClosedForm, map_of
from safestart.closed_form.paper import range_limit
from safestart.processes.base import ProcessOutput
from safestart.processes.benchmark.spec import BenchmarkQuestion
from safestart.processes.certificate.spec import CertificateInputs
from safestart.processes.wire import NO_SYNC_LIMIT, finite
from safestart.runtime.progress import Context


def answer(inputs: CertificateInputs | BenchmarkQuestion) -> dict[str, Any]:
    """The certificate document of an operating point and a grid."""
    scenario, grid = inputs.scenario(), inputs.grid.grid()
    name: ClosedForm = inputs.certificate if isinstance(inputs, CertificateInputs) else "certified"
    region = map_of(name, scenario, grid, inputs.rest)
    paper = region if name == "paper" else map_of("paper", scenario, grid, inputs.rest)
    x, y = grid.axes(scenario.corridor)
    limit = range_limit(scenario, inputs.rest)
    return {
        "certificate": name,
        "r_sync_m": finite(limit),
        "r_sync_reason": None if math.isfinite(limit) else NO_SYNC_LIMIT,
        "safe_fraction": region.safe_fraction,
        "paper_safe_fraction": paper.safe_fraction,
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

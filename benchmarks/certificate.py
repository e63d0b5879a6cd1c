"""The certificate map in process: no peer, an absolute time (the paper needs about 10 ms)."""

from __future__ import annotations

from benchmarks.timing import median_seconds
from safestart.closed_form.paper import certify_grid
from safestart.model.scenario import Grid, Scenario


def measure() -> dict[str, dict[str, float]]:
    """Median time of the 31 x 31 map."""
    scenario, grid = Scenario.of(3.0, 0.1), Grid()
    return {
        "ratios": {},
        "times": {"certificate_map_s": median_seconds(lambda: certify_grid(scenario, grid), 2000)},
    }

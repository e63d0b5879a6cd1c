"""GET /go-no-go beside a bare FastAPI endpoint, in the form that ``safestart bench`` collects."""

from __future__ import annotations

from benchmarks import go_no_go


def measure() -> dict[str, dict[str, float]]:
    """Ratio of requests per second, and the time one request takes with the server saturated."""
    found = go_no_go.measure()
    return {
        "ratios": {"go_no_go_vs_bare": found["ratio"]},
        "times": {"go_no_go_s": 1.0 / found["rps_service"], "go_no_go_bare_s": 1.0 / found["rps_bare"]},
    }

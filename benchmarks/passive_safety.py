"""The passive-safety verifier: seconds per job, and ``python -m benchmarks.passive_safety FLIGHTS`` for its audit.

The published tools are not installed here, so there is no peer to run beside; their figures are in
``safestart reproduce passive-safety``.
"""

from __future__ import annotations

import sys
from statistics import median

from benchmarks.timing import median_seconds, once
from safestart.verification.audit import drift_excess, powered_excess
from safestart.verification.cases import CASES, HORIZON
from safestart.verification.critical import critical_abort
from safestart.verification.question import Question
from safestart.verification.reach import reach
from safestart.verification.rows import PAPER_JOB, competition_rows, warm
from safestart.verification.verify import verify

RUNS = 15
_CHUNK = 5000


def measure() -> dict[str, dict[str, float]]:
    """Times in seconds: medians of warm runs; ``tables_s`` is what a process pays once before."""
    tables = once(warm)
    return {
        "ratios": {},
        "times": {
            "passive_safety_tables_s": tables,
            "passive_safety_paper_job_s": median_seconds(lambda: verify(PAPER_JOB), RUNS),
            "passive_safety_sra08_s": median_seconds(
                lambda: verify(Question(horizon=HORIZON, window=CASES["SRA08"], box=0.2)), RUNS
            ),
            "passive_safety_22_cells_s": median(
                sum(row["run_s"] for row in competition_rows()) for _ in range(5)
            ),
            "passive_safety_critical_abort_s": median_seconds(
                lambda: critical_abort(Question(horizon=360.0), 0.0, HORIZON), 3
            ),
        },
    }


def audit(flights: int) -> int:
    """Print, per row of the competition, the largest excess of simulated flights over their sets; 1 if positive."""
    failed = 0
    for case, window in CASES.items():
        question = Question(horizon=HORIZON, window=window)
        tubes = reach(question)
        worst = -float("inf")
        for k in range(-(-flights // _CHUNK)):
            worst = max(worst, powered_excess(question, tubes, min(_CHUNK, flights), 2 * k, 8))
            if tubes.branches and window is not None:
                worst = max(worst, drift_excess(question, tubes, min(_CHUNK, flights), 2 * k + 1, k % 6))
        failed |= worst > 0.0
        print(f"{case}: {flights} flights, largest excess {worst:.3g} (negative: none outside)", flush=True)
    return int(failed)


if __name__ == "__main__":
    sys.exit(audit(int(sys.argv[1]) if len(sys.argv) > 1 else 100_000))

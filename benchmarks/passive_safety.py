"""The passive-safety verifier: seconds per job; ``python -m benchmarks.passive_safety FLIGHTS VARIANT`` audits it.

The published tools are not installed here, so there is no peer to run beside; their figures are in
``safestart reproduce passive-safety``.
"""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from statistics import median

from benchmarks.asked import parser
from benchmarks.peers.reach_audit import drift_excess, powered_excess
from benchmarks.timing import median_seconds, once
from safestart.passive_safety.cases import CASES, HORIZON
from safestart.passive_safety.competition import PAPER_JOB, competition_rows
from safestart.passive_safety.critical import critical_abort
from safestart.passive_safety.gains import PUBLISHED_DESIGN
from safestart.passive_safety.model import PUBLISHED, Dynamics, System
from safestart.passive_safety.question import Question
from safestart.passive_safety.reach.reach_set import Reach, reach
from safestart.passive_safety.switching_guard import Guard
from safestart.passive_safety.verify import verify
from safestart.passive_safety.warm import warm

RUNS = 15
SYSTEMS = {
    "linear": PUBLISHED,
    "circle": System(guard=Guard.CIRCLE),
    "nonlinear": System(Dynamics.NONLINEAR),
    "all": System(Dynamics.NONLINEAR, PUBLISHED_DESIGN, Guard.CIRCLE),
}
"""Variants by the name that the audit takes; ``all``: nonlinear, gains by Bryson's rule, circle."""
_CHUNK = 2000


def measure() -> dict[str, dict[str, float]]:
    """Times in seconds: medians of warm runs; ``tables_s`` is the one-time cost of a process."""
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
            "passive_safety_nonlinear_no_failure_s": median_seconds(
                lambda: verify(Question(horizon=HORIZON, system=SYSTEMS["nonlinear"])), RUNS
            ),
            "passive_safety_nonlinear_sra08_s": median_seconds(
                lambda: verify(
                    Question(horizon=HORIZON, window=CASES["SRA08"], box=0.2, system=SYSTEMS["nonlinear"])
                ),
                RUNS,
            ),
            "passive_safety_critical_abort_s": median_seconds(
                lambda: critical_abort(Question(horizon=360.0), 0.0, HORIZON), 3
            ),
        },
    }


def audit(flights: int, chosen: str) -> int:
    """Print the largest excess of simulated flights over their sets, per row of the competition; 1 if positive."""
    failed = 0
    system = SYSTEMS[chosen]
    # The rows differ in their windows alone: of a variant whose flights take long the widest window does.
    windows = {"any abort": (0.0, HORIZON)} if system.dynamics is Dynamics.NONLINEAR else CASES
    for case, window in windows.items():
        question = Question(horizon=HORIZON, window=window, system=system)
        tubes = reach(question)
        chunk = min(_CHUNK, flights)

        def one(k: int, question: Question = question, tubes: Reach = tubes, chunk: int = chunk) -> float:
            worst = powered_excess(question, tubes, chunk, 2 * k, 8)
            if tubes.branches and question.window is not None:
                worst = max(worst, drift_excess(question, tubes, chunk, 2 * k + 1, k % 6, k % 5))
            return worst

        with ThreadPoolExecutor(2) as pool:
            worst = max(pool.map(one, range(-(-flights // chunk))))
        failed |= worst > 0.0
        print(
            f"{chosen}, {case}: {flights} flights, largest excess {worst:.3g} (negative: none outside)",
            flush=True,
        )
    return int(failed)


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("flights", nargs="?", type=int, default=100_000)
    asked.add_argument("variant", nargs="?", choices=tuple(SYSTEMS), default="linear")
    given = asked.parse_args()
    sys.exit(audit(given.flights, given.variant))

"""Closed-loop Monte Carlo against the same loop in Python with OSQP, per control step, and the whole map's time.

Compared on cells whose flights are complete and whose filter is feasible at every step: where it is not, the peer
pays for an LP besides, which would flatter ours. Both fly the same starts with the same gains.
"""

from __future__ import annotations

import json
from statistics import median

import numpy as np

from benchmarks.asked import parser
from benchmarks.peers.osqp_loop import OsqpLoop
from benchmarks.timing import side_by_side
from safestart.control.forecast import flight_plan
from safestart.control.gains import TUNED
from safestart.engines.base import Problem
from safestart.engines.monte_carlo import MonteCarlo
from safestart.model.scenario import Rest, Scenario
from safestart.runtime.progress import Context
from safestart.simulation.compiled_loop import fly
from safestart.simulation.starts import start_states

RATES_DEG_S = (1.0, 3.0)
CELLS = 12


def measure(runs: int = 7) -> dict[str, dict[str, float]]:
    """Ratio of the times per control step at each tumble rate, the times of both, and the 31 x 31 map."""
    ratios: dict[str, float] = {}
    times: dict[str, float] = {}
    for rate in RATES_DEG_S:
        scenario = Scenario.of(rate, 0.1)
        problem = Problem(scenario)
        plan = flight_plan(scenario, TUNED, problem.dt, 30)
        starts = start_states(scenario, problem.points()[problem.inside()], Rest.LVLH)
        flights = fly(plan, starts)
        clean = np.flatnonzero(flights.safe & (flights.fallbacks == 0))
        starts = starts[clean[:: max(1, len(clean) // CELLS)]]
        steps = int(fly(plan, starts).steps.sum())
        peer = OsqpLoop(scenario, TUNED, problem.dt, 30)
        # Ours is over in microseconds: many copies of the starts make it measurable.
        copies = 100
        many = np.tile(starts, (copies, 1))

        def ours(plan=plan, many=many) -> None:  # type: ignore[no-untyped-def]
            fly(plan, many)

        def theirs(peer=peer, starts=starts) -> None:  # type: ignore[no-untyped-def]
            peer.fly_all(starts)

        own, other = side_by_side(ours, theirs, runs)
        label = f"at_{rate:g}"
        times[f"control_step_{label}_s"] = own / (steps * copies)
        times[f"control_step_osqp_{label}_s"] = other / steps
        ratios[f"closed_loop_{label}"] = copies * other / own
        MonteCarlo().solve(problem, Context())
        results = [MonteCarlo().solve(problem, Context()) for _ in range(runs)]
        times[f"monte_carlo_map_{label}_s"] = median(result.run_s for result in results)
    headline = min(ratios[f"closed_loop_at_{rate:g}"] for rate in RATES_DEG_S)
    return {"ratios": {"monte_carlo_vs_osqp": headline} | ratios, "times": times}


if __name__ == "__main__":
    parser(__doc__).parse_args()
    print(json.dumps(measure(), indent=2))

"""Hopping approaches: hop times, one MPC step beside other solvers, approaches flown, proofs.

``python -m benchmarks.hopping`` prints all of it; ``--approaches N`` flies fewer of them. OSQP is asked where it is
installed. Random plans have a benchmark of their own (``benchmarks.random_plans``).
"""

from __future__ import annotations

import argparse
import json
import math
import time
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from importlib import import_module
from multiprocessing import get_context
from typing import Any

import numpy as np

from benchmarks.timing import median_seconds, once
from safestart.campaign.case import Case
from safestart.dynamics.cwh import transition_matrix
from safestart.hopping.approach import approach, mean_motion_of
from safestart.hopping.barrier import Noise
from safestart.hopping.compiled_program import CompiledProgram
from safestart.hopping.hop_program import HopProgram
from safestart.hopping.hop_time import hop_phases
from safestart.hopping.hop_time_kernel import compiled_hop_phases
from safestart.hopping_flights.fly import World, fly
from safestart.missed_burn.cases import cases_of
from safestart.missed_burn.plan import Burn, Errors, Failures, Plan, Question
from safestart.missed_burn.prove import bound, prove

N = mean_motion_of(8.1e6)
ORBIT = math.tau / N
NOISE = Noise(0.5, 1e-3, 0.01, math.radians(0.5))
STUDY = Errors((0.5,) * 3, (1e-3,) * 3, 0.01, math.radians(0.5))
FAILURES = Failures(60.0, True, 5.0, 0.002, math.radians(5.0))


def hop_times(count: int = 100_000) -> dict[str, float]:
    """Seconds for so many pairs of angle and share."""
    rng = np.random.default_rng(0)
    angles, shares = rng.uniform(0.0, 145.0, count), rng.uniform(0.0, 0.99, count)
    return {
        "pairs": count,
        "ms": 1e3 * median_seconds(lambda: compiled_hop_phases(angles, shares), 9),
        "numpy_ms": 1e3 * median_seconds(lambda: hop_phases(angles, shares), 5),
    }


def steps(approaches: int = 100) -> dict[str, Any]:
    """Steps of the V-bar's MPC with the tightened barrier, ms: whole commands, and the same first programs."""
    world = World(noise=NOISE, barrier="tightened", kappa=3.0)
    steer, rng = world.controller(), np.random.default_rng(1)
    whole: list[float] = []
    programs: list[tuple[Any, ...]] = []
    for number in range(approaches + 2):
        state = np.array([0.0, 2000.0 * (1.0 + 0.1 * rng.uniform(-1, 1)), *rng.uniform(-0.1, 0.1, 4)])
        for k in range(len(steer.distances)):
            believed = state + np.repeat([0.5, 1e-3], 3) * rng.standard_normal(6)
            begin = time.perf_counter()
            impulse = steer.command(k, believed).impulse
            if number >= 2:
                whole.append(time.perf_counter() - begin)
                remaining = steer.distances[k + 1 :]
                if number < 12:
                    times = steer._times(believed, remaining)
                    programs.append((N, steer.axes, remaining, times, believed, world.weights))
            assert impulse is not None
            state[3:] += impulse
            state = transition_matrix(N, steer.wait()) @ state
    said: dict[str, Any] = {
        "steps": len(whole),
        "median_ms": 1e3 * float(np.median(whole)),
        "p99_ms": 1e3 * float(np.percentile(whole, 99)),
    }
    for name, solve in _solvers().items():
        solve(programs[0])
        spent = [once(partial(solve, program)) for program in programs]
        said[f"{name}_program_ms"] = 1e3 * float(np.median(spent))
    return said


def _solvers() -> dict[str, Any]:
    """One program without a barrier, assembled and solved."""
    found: dict[str, Any] = {
        "ours": lambda p: CompiledProgram(*p).solve(),
        "clarabel": lambda p: HopProgram(*p).solve(),
    }
    try:
        osqp = import_module("osqp")
    except ImportError:
        return found
    found["osqp"] = lambda p: _by_osqp(osqp, HopProgram(*p))
    return found


def _by_osqp(osqp: Any, program: HopProgram) -> None:
    """The same cost with a slack for every soft row, and the impulses split."""
    from scipy.sparse import csc_matrix, diags

    c, rows = program.count, len(program.soft)
    gram = (program.tracked * program.costs[:, None]).T @ program.tracked
    pull = program.tracked.T @ (program.costs * program.targets)
    square = np.zeros((2 * c + rows, 2 * c + rows))
    square[: 2 * c, : 2 * c] = 2.0 * np.block([[gram, -gram], [-gram, gram]])
    cost = np.concatenate([1.0 - 2.0 * pull, 1.0 + 2.0 * pull, program.scales])
    edge = np.where(np.isfinite(program.tolerance), program.tolerance, 0.0)
    two = np.isfinite(program.tolerance)
    one = np.hstack([program.soft, -program.soft, np.eye(rows)])
    other = np.hstack([-program.soft, program.soft, np.eye(rows)])[two]
    matrix = np.vstack([one, other, np.eye(2 * c + rows)])
    low = np.concatenate([-edge - program.level, (program.level - edge)[two], np.zeros(2 * c + rows)])
    solver = osqp.OSQP()
    solver.setup(
        csc_matrix(np.triu(square)) + 0.0 * diags(np.ones(len(square))),
        cost,
        csc_matrix(matrix),
        low,
        np.full(len(low), np.inf),
        verbose=False,
        eps_abs=1e-7,
        eps_rel=1e-7,
        max_iter=100_000,
    )
    solver.solve()


def approaches(count: int = 10_000, cores: int = 2) -> dict[str, float]:
    """Seconds for V-bar approaches about the true Earth, each with an abort of two orbits after every impulse."""
    begin = time.perf_counter()
    with ProcessPoolExecutor(cores, get_context("spawn")) as pool:
        list(pool.map(_warm, range(cores)))
        warm = time.perf_counter()
        cut = [(first, min(first + 100, count)) for first in range(0, count, 100)]
        parts = list(pool.map(_flown, cut))
        breaches = sum(found for found, _ in parts)
    end = time.perf_counter()
    aborts = 6 * count
    return {
        "approaches": count,
        "aborts": aborts,
        "seconds": end - warm,
        "processor_seconds": sum(spent for _, spent in parts),
        "start_seconds": warm - begin,
        "breaches": breaches,
    }


def _warm(_: int) -> None:
    _flown((0, 1))


def _flown(part: tuple[int, int]) -> tuple[int, float]:
    """Breaches, and what they cost on a processor, s: a busy machine takes longer."""
    begin = time.process_time()
    world = World(noise=NOISE)
    steer = world.controller()
    flights = (fly(world, Case(k, 0).generator(), steer) for k in range(*part))
    found = sum(bool((flight.closest[:-1] < world.keep_out).any()) for flight in flights)
    return found, time.process_time() - begin


def proofs() -> dict[str, float]:
    """Proof of one hop, ms; of a plan of 20 burns with all five kinds of failure, s, and as burns of 10 s."""
    made = approach(N, 40.0, 2000.0, 100.0, 5)
    plan = Plan.of(N, made.states()[0].tolist(), made.times.tolist(), made.impulses)
    question = Question(plan, 50.0, 2.0 * ORBIT, STUDY)
    hop = next(case for case in cases_of(question) if case.kind == "made" and case.burn == 4)
    made = approach(N, 40.0, 2000.0, 100.0, 19)
    long = Plan.of(N, made.states()[0].tolist(), made.times.tolist(), made.impulses)
    lasting = Plan(N, long.start, tuple(Burn(b.time, b.impulse, 10.0) for b in long.burns))
    said = {"hop_ms": 1e3 * median_seconds(lambda: bound(hop, question, math.inf), 50)}
    for name, one in (("plan_of_20", long), ("lasting_plan_of_20", lasting)):
        whole = Question(one, 50.0, 2.0 * ORBIT, STUDY, FAILURES)
        said[f"{name}_s"] = median_seconds(partial(prove, whole, sharp=False), 3)
    return said


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--approaches", type=int, default=10_000)
    parser.add_argument("--only", choices=("hop_times", "steps", "approaches", "proofs"))
    given = parser.parse_args()
    work = {
        "hop_times": hop_times,
        "steps": steps,
        "proofs": proofs,
        "approaches": lambda: approaches(given.approaches),
    }
    said = {name: call() for name, call in work.items() if given.only in (None, name)}
    print(json.dumps(said, indent=1))


if __name__ == "__main__":
    main()

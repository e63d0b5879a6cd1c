"""The tracking MPC at paper 002's set-up: one step beside other solvers, regions, flights with errors, random programs.

``python -m benchmarks.tracking_mpc`` prints all of it. DAQP, quadprog and OSQP are asked where they are installed;
their times are of the solution alone, ours are of assembly and solution.
"""

from __future__ import annotations

import json
import math
import statistics
import time
from concurrent.futures import ProcessPoolExecutor
from importlib import import_module
from multiprocessing import get_context
from typing import Any

import numpy as np

from benchmarks.asked import parser
from benchmarks.timing import median_seconds
from safestart.campaign.case import Case
from safestart.control.tracking_mpc.assemble import assemble
from safestart.control.tracking_mpc.controller import Program
from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.step_kernel import INFEASIBLE, SOLVED, solve_from
from safestart.control.tracking_mpc.theta_set import theta_set
from safestart.control.tracking_mpc.tumble import Tumble
from safestart.control.tracking_mpc.tuning import DockingCorridor, Tuning
from safestart.processes.tracking_mpc.noisy import flights_of, one
from safestart.processes.tracking_mpc.spec import TrackingMpcInputs
from safestart.runtime.kernels.compiled import compiled
from safestart.tracking.any_history import AnyHistory
from safestart.tracking.certificate import recursion, shifts_needed
from safestart.tracking.flight import fly
from safestart.tracking.region import by_any_history, by_program, grid_of

INPUTS = TrackingMpcInputs.model_validate({})
INERTIA: Any = tuple(tuple(row) for row in INPUTS.inertia_kg_m2)
RATE = math.radians(3.53)
STARTS = ((1.5, 2.5, 1.5), (4.0, 6.0, 2.0), (-3.0, 8.0, 1.0))


@compiled(error_model="numpy")
def step(  # type: ignore[no-untyped-def]
    attitudes, fixed, start, spots, held, low, high, state, rows, shift, hessian, slope, z, dual
):
    """One step as compiled flights take it: assembly and solution; returns (status, steps)."""
    assemble(attitudes, fixed, start, spots, held, rows, shift, hessian, slope)
    return solve_from(rows, shift, hessian, slope, low, high, state, z, dual)


def case(tuning: Tuning, rate: Any = (0.0, RATE, RATE), window: int = 320) -> tuple[Program, Any, Tumble]:
    """A program and its attitudes."""
    tumble = Tumble(INERTIA, (1.0, 0.0, 0.0, 0.0), rate, INPUTS.mean_motion, "inertial")
    motion, shape = Sampled(INPUTS.mean_motion, 1.0), DockingCorridor()
    attitudes = tumble.nodes(1.0, window)
    limit = theta_set(tuning, shape, tumble, motion, attitudes)
    return Program(motion, shape, tuning, limit), attitudes, tumble


def steps(rounds: int = 20) -> dict[str, float]:
    """Median and p99 of one step, us; medians of others' solutions of the same programs."""
    mpc, attitudes, _ = case(Tuning())
    z, dual = np.empty(len(mpc.rows)), np.empty(len(mpc.high))
    ours: list[float] = []
    others: dict[str, list[float]] = {}
    solvers = _solvers()
    for turn in range(rounds):
        for start in STARTS:
            state = np.array([*start, 0.0, 0.0, 0.0])
            for k in range(40):
                ahead = np.ascontiguousarray(attitudes[k : k + mpc.ahead])
                begin = time.perf_counter()
                status, _ = step(
                    ahead,
                    mpc.fixed,
                    mpc.start,
                    mpc.spots,
                    mpc.held,
                    mpc.low,
                    mpc.high,
                    state,
                    mpc.rows,
                    mpc.shift,
                    mpc.hessian,
                    mpc.slope,
                    z,
                    dual,
                )
                ours.append(time.perf_counter() - begin)
                if status != SOLVED:
                    break
                if turn == 0:
                    for name, solve in solvers.items():
                        others.setdefault(name, []).append(solve(mpc, state))
                state = mpc.plan(ahead, state).states[1]
    out = {
        "step_us": 1e6 * statistics.median(ours[50:]),
        "step_p99_us": 1e6 * float(np.percentile(ours[50:], 99)),
    }
    return out | {f"{name}_us": 1e6 * statistics.median(times) for name, times in others.items()}


def _solvers() -> dict[str, Any]:
    """Each: seconds of one solution, without building its arrays."""
    import clarabel
    from scipy.sparse import csc_matrix

    def arrays(mpc: Program, state: Any) -> tuple[Any, ...]:
        moved = state @ mpc.shift
        return mpc.hessian.copy(), mpc.slope @ state, mpc.rows.T.copy(), mpc.high - moved, mpc.low - moved

    def two_sided(mpc: Program, state: Any) -> tuple[Any, ...]:
        h, g, a, up, low = arrays(mpc, state)
        both = np.isfinite(low)
        return h, g, np.vstack([a, -a[both]]), np.append(up, -low[both])

    settings = clarabel.DefaultSettings()
    settings.verbose = False

    def by_clarabel(mpc: Program, state: Any) -> float:
        h, g, a, b = two_sided(mpc, state)
        upper, rows, cones = csc_matrix(np.triu(h)), csc_matrix(a), [clarabel.NonnegativeConeT(len(b))]
        begin = time.perf_counter()
        clarabel.DefaultSolver(upper, g, rows, b, cones, settings).solve()
        return time.perf_counter() - begin

    found: dict[str, Any] = {"clarabel": by_clarabel}
    for name in ("daqp", "quadprog", "osqp"):
        try:
            module = import_module(name)
        except ImportError:
            continue

        def by_other(mpc: Program, state: Any, name: str = name, module: Any = module) -> float:
            h, g, a, up, low = arrays(mpc, state)
            if name == "daqp":
                begin = time.perf_counter()
                module.solve(h, g, a, up, np.maximum(low, -1e30))
            elif name == "quadprog":
                h, g, both, bound = two_sided(mpc, state)
                both, bound = np.ascontiguousarray(-both.T), -bound
                begin = time.perf_counter()
                module.solve_qp(h, -g, both, bound)
            else:
                solver = module.OSQP()
                upper, rows = csc_matrix(np.triu(h)), csc_matrix(a)
                begin = time.perf_counter()
                solver.setup(upper, g, rows, low, up, verbose=False, eps_abs=1e-6, eps_rel=1e-6)
                solver.solve()
            return time.perf_counter() - begin

        found[name] = by_other
    return found


def regions() -> dict[str, float]:
    """Seconds for 930 starts."""
    mpc, attitudes, _ = case(Tuning())
    grid = grid_of(mpc.shape, 30)

    def exact() -> Any:
        histories = AnyHistory(mpc.motion, mpc.shape, 0.075, attitudes[:61])
        return by_any_history(histories, attitudes[0], grid)

    return {
        "region_930_s": median_seconds(lambda: by_program(mpc, attitudes, grid), 5),
        "exact_930_s": median_seconds(exact, 3),
    }


def noise(runs: int, variants: tuple[str, ...] = ("hard", "soft", "tube")) -> dict[str, Any]:
    """Flights of 60 s with the default errors: runs inside, always with a plan; seconds per 1000."""
    out: dict[str, Any] = {}
    for variant in variants:
        inputs = TrackingMpcInputs.model_validate({"study": {"runs": runs, "variant": variant}})
        assert inputs.study is not None
        setup, flights = flights_of(inputs, inputs.study)
        one(inputs, inputs.study, setup, flights, Case(0))
        begin = time.perf_counter()
        done = [one(inputs, inputs.study, setup, flights, Case(index)) for index in range(runs)]
        seconds = time.perf_counter() - begin
        out[variant] = {
            "runs": runs,
            "outside": sum(not row["inside"] for row in done),
            "without_a_plan": sum(not row["always_planned"] for row in done),
            "over_the_input": sum(not row["within_input"] for row in done),
            "seconds_per_1000": 1e3 * seconds / runs,
        }
    return out


def closed_loop(count: int = 10_000, cores: int = 2) -> dict[str, float]:
    """Seconds for so many flights of 60 s with the default errors (tube), compilation apart; and on a processor, as a
    busy machine takes longer."""
    with ProcessPoolExecutor(cores, get_context("spawn")) as pool:
        list(pool.map(_flights, [(0, 1)] * cores))
        begin = time.perf_counter()
        parts = [(first, min(first + 100, count)) for first in range(0, count, 100)]
        found = list(pool.map(_flights, parts))
    return {
        "flights": count,
        "outside": sum(outside for outside, _ in found),
        "seconds": time.perf_counter() - begin,
        "processor_seconds": sum(spent for _, spent in found),
    }


def _flights(part: tuple[int, int]) -> tuple[int, float]:
    begin = time.process_time()
    inputs = TrackingMpcInputs.model_validate({"study": {"runs": 1}})
    assert inputs.study is not None
    setup, flights = flights_of(inputs, inputs.study)
    done = [one(inputs, inputs.study, setup, flights, Case(index)) for index in range(*part)]
    return sum(not row["inside"] for row in done), time.process_time() - begin


def recursive(starts: int) -> dict[str, Any]:
    """Random feasible starts x 3 tunings, 60 s each: flights that lost their plan, plans not certified."""
    out = {}
    for rho, tau in ((1.0, 1.0), (1.0, 100.0), (100.0, 100.0)):
        mpc, attitudes, tumble = case(Tuning(rho=rho, tau=tau))
        rng, shifts = np.random.default_rng(1), shifts_needed(mpc.condensed.closed)
        done = lost = unproved = 0
        while done < starts:
            y = rng.uniform(0.3, 10.0)
            place = np.array([rng.uniform(-y, y), y, rng.uniform(-y, y)])
            start = np.concatenate([attitudes[0].T @ place, rng.normal(0.0, 0.03, 3)])
            if not mpc.plan(attitudes, start).feasible:
                continue
            flight = fly(mpc, tumble, attitudes, start, 60)
            done += 1
            lost += not flight.finished
            unproved += sum(
                not recursion(mpc, attitudes[k:], p, shifts).holds for k, p in enumerate(flight.plans)
            )
        out[f"rho {rho:g}, tau {tau:g}"] = {"starts": done, "lost": lost, "plans_not_certified": unproved}
    return out


def random_programs(count: int) -> dict[str, Any]:
    """Our solutions beside DAQP's and quadprog's, where installed: differences of the minimum and of the verdict."""
    rng = np.random.default_rng(11)
    names = [name for name in ("daqp", "quadprog") if _has(name)]
    worst, differ, infeasible = dict.fromkeys(names, 0.0), dict.fromkeys(names, 0), 0
    done = 0
    while done < count:
        tuning = Tuning(
            float(rng.uniform(0.02, 0.2)),
            int(rng.integers(1, 6)),
            30,
            10.0 ** rng.uniform(-1, 3),
            10.0 ** rng.uniform(-1, 3),
        )
        mpc, attitudes, _ = case(tuning, tuple(rng.normal(0.0, 0.05, 3)), 120)
        for k in range(20):
            y = rng.uniform(0.1, 8.0)
            state = np.array([rng.uniform(-y, y), y, rng.uniform(-y, y), *rng.normal(0.0, 0.03, 3)])
            mpc.assemble(attitudes[k:])
            z, dual = np.empty(len(mpc.rows)), np.empty(len(mpc.high))
            status, _ = solve_from(
                mpc.rows, mpc.shift, mpc.hessian, mpc.slope, mpc.low, mpc.high, state, z, dual
            )
            done, infeasible = done + 1, infeasible + (status == INFEASIBLE)
            moved = state @ mpc.shift
            up, low, g = mpc.high - moved, mpc.low - moved, mpc.slope @ state
            for name in names:
                theirs = _theirs(name, mpc, g, up, low)
                if (theirs is None) != (status != SOLVED):
                    differ[name] += 1
                elif theirs is not None:
                    values = [0.5 * v @ mpc.hessian @ v + g @ v for v in (z, theirs)]
                    worst[name] = max(
                        worst[name], float(abs(values[0] - values[1]) / max(1.0, abs(values[0])))
                    )
    return {
        "programs": done,
        "infeasible": infeasible,
        "worst_difference": worst,
        "verdicts_that_differ": differ,
    }


def _theirs(name: str, mpc: Program, g: Any, up: Any, low: Any) -> Any:
    module = import_module(name)
    rows = mpc.rows.T.copy()
    if name == "daqp":
        x, _, flag, _ = module.solve(
            mpc.hessian.copy(), g, rows, up, np.maximum(low, -1e30), primal_tol=1e-10
        )
        return x if flag == 1 else None
    both = np.isfinite(low)
    try:
        return module.solve_qp(
            mpc.hessian.copy(),
            -g,
            np.ascontiguousarray(-np.vstack([rows, -rows[both]]).T),
            -np.append(up, -low[both]),
        )[0]
    except ValueError:
        return None


def _has(name: str) -> bool:
    try:
        import_module(name)
    except ImportError:
        return False
    return True


def measure() -> dict[str, dict[str, float]]:
    """One step, the regions and 1000 flights: absolute times, and one step beside Clarabel's solution alone."""
    one_step = steps(5)
    flown = noise(100, ("tube",))["tube"]["seconds_per_1000"]
    return {
        "ratios": {"clarabel_over_step": one_step["clarabel_us"] / one_step["step_us"]},
        "times": {"step_s": 1e-6 * one_step["step_us"], **regions(), "thousand_flights_s": flown},
    }


if __name__ == "__main__":
    parser(__doc__).parse_args()
    print(json.dumps({"step": steps(), "regions": regions(), "noise": noise(1000)}, indent=1))
    print(json.dumps({"closed_loop": closed_loop()}, indent=1))
    print(json.dumps({"recursive": recursive(200), "programs": random_programs(10_000)}, indent=1))

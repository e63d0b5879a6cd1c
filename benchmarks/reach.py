"""The set engines beside their peers: hj-reachability, 961 linear programs, the recursion cell by cell."""

from __future__ import annotations

from statistics import median

from benchmarks.peers.highs_lp import slack_map
from benchmarks.peers.literal_forward import literal_map
from benchmarks.timing import once
from safestart.engines.backward import Backward
from safestart.engines.base import Engine, Problem
from safestart.engines.exact import Exact
from safestart.engines.forward import Forward
from safestart.engines.hamilton_jacobi import HamiltonJacobi
from safestart.engines.hj.options import HamiltonJacobiInput
from safestart.model.scenario import Scenario, SetKind
from safestart.runtime.progress import Context

RATE_DEG_S, THRUST = 3.0, 0.1
FAST_RUNS, PEER_RUNS = 21, 3
LITERAL_CELLS = 40
"""Cells of the literal recursion that are timed; its cost per cell is the same for each."""


def measure() -> dict[str, dict[str, float]]:
    """Ratios peer / ours at 3 deg/s, 0.10 m/s^2, 31 x 31, 40 s; medians; compilation is not counted on either side."""
    tube = Problem(Scenario.of(RATE_DEG_S, THRUST), kind=SetKind.TUBE)
    fixed = Problem(Scenario.of(RATE_DEG_S, THRUST))
    cells = fixed.grid.nx * fixed.grid.ny
    # The paper's formulation (body frame), and the same solver in LVLH, the faster of the two.
    theirs = HamiltonJacobiInput(accuracy="low", solver="hj_reachability", frame="body")
    exact, hj = _beside(Exact(), tube, lambda: _run(HamiltonJacobi(theirs), tube))
    lvlh = theirs.model_copy(update={"frame": "lvlh"})
    _, hj_lvlh = _beside(Exact(), tube, lambda: _run(HamiltonJacobi(lvlh), tube))
    backward, programs = _beside(Backward(), fixed, lambda: once(lambda: slack_map(fixed)))
    part = slice(0, LITERAL_CELLS)
    forward, literal = _beside(
        Forward(), fixed, lambda: once(lambda: literal_map(fixed, part)) * cells / LITERAL_CELLS
    )
    return {
        "ratios": {
            "exact_vs_hj_low": hj / exact,
            "exact_vs_hj_low_lvlh": hj_lvlh / exact,
            "backward_vs_lp": programs / backward,
            "forward_vs_literal": literal / forward,
        },
        "times": {
            "exact_tube_s": exact,
            "hj_low_tube_s": hj,
            "hj_low_tube_lvlh_s": hj_lvlh,
            "backward_s": backward,
            "backward_961_lps_s": programs,
            "forward_s": forward,
            "forward_literal_s": literal,
        },
    }


def _run(engine: Engine, problem: Problem) -> float:
    return engine.solve(problem, Context()).run_s


def _beside(ours: Engine, problem: Problem, peer: object) -> tuple[float, float]:
    """Medians of ours and of the peer, in turns: each peer run between two batches of ours."""
    assert callable(peer)
    _run(ours, problem)
    fast: list[float] = []
    slow: list[float] = []
    for _ in range(PEER_RUNS):
        fast += [_run(ours, problem) for _ in range(FAST_RUNS // PEER_RUNS)]
        slow.append(peer())
    return median(fast), median(slow)

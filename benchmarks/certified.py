"""`certified` against the exact answer: false GOs, how much it keeps of the paper's conditions, its time.

``python -m benchmarks.certified starts [COUNT] [SEED] [FILE]`` puts starts to the exact answer where a false GO is
likeliest (`certified_starts`; COUNT 1000000 takes hours on one core, FILE lets it be stopped and go on).
``python -m benchmarks.certified cells [SIZE]`` goes through the operating points of Table 1. Without either it measures
times. All print one JSON document.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.asked import parser
from benchmarks.certified_starts import HORIZONS, question_of, starts, state_of
from benchmarks.timing import median_seconds
from safestart.closed_form.certified import certify, certify_grid
from safestart.closed_form.certified_point import certify_point, prepare
from safestart.closed_form.paper import certify as paper_certify
from safestart.closed_form.paper import certify_grid as paper_grid
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.model.scenario import Grid, Rest, Scenario

RATES = (1.0, 2.0, 3.0, 4.0, 5.0)
THRUSTS = (0.20, 0.10, 0.05, 0.01)


def cells(size: int) -> list[dict[str, Any]]:
    """Each operating point of Table 1: starts of the paper's conditions, those right over 60 to 600 s, those kept.

    A size x size grid over the corridor cut at 150 m or just beyond the paper's range limit, whichever is nearer. The
    exact answer is asked of the starts that the paper's conditions certify and the certificate does not; those that
    both certify are right by the theorem, which ``starts`` puts to the test.
    """
    return [_cell(omega, thrust, size) for omega in RATES for thrust in THRUSTS]


def _cell(omega: float, thrust: float, size: int) -> dict[str, Any]:
    scenario = Scenario.of(omega, thrust)
    grid = Grid(size, size, min(150.0, max(1.02 * scenario.sync_radius, 1.0)))
    points = grid.points(scenario.corridor).reshape(-1, 2)
    theirs, ours = paper_certify(scenario, points).safe, certify(scenario, points).go
    found: dict[str, Any] = {"omega_t_deg_s": omega, "a_max_m_s2": thrust, "paper": int(theirs.sum())}
    both, left = int((ours & theirs).sum()), np.flatnonzero(theirs & ~ours).tolist()
    for horizon in HORIZONS:
        question = question_of(scenario, 2, horizon)
        # A start that cannot stay this long cannot stay longer.
        left = [
            i
            for i in left
            if decide(question, state_of(scenario, points[i], Rest.LVLH), verdict_only=True).verdict
            is Verdict.GO
        ]
        found[f"paper_right_{horizon:g}_s"] = both + len(left)
        found[f"kept_of_right_{horizon:g}_s"] = both / (both + len(left)) if both + len(left) else None
    return {**found, "ours": int(ours.sum()), "area_over_paper": float(ours.sum() / theirs.sum())}


def measure() -> dict[str, dict[str, float]]:
    """Median times of the 31 x 31 map, beside the paper's conditions, and of one start in plain floats."""
    scenario, grid = Scenario.of(3.0, 0.1), Grid()
    ours = median_seconds(lambda: certify_grid(scenario, grid), 2000)
    theirs = median_seconds(lambda: paper_grid(scenario, grid), 2000)
    target, shape = scenario.target, scenario.corridor
    times = {}
    for name, spatial in (("planar", False), ("spatial", True)):
        given = prepare(target.tumble_rate, target.mean_motion, 0.1, shape, Rest.LVLH, spatial)
        place = (3.0, 40.0, 5.0 if spatial else 0.0)
        times[f"certified_point_{name}_s"] = (
            median_seconds(
                lambda given=given, place=place: [certify_point(given, *place) for _ in range(100)], 200
            )
            / 100
        )
    return {
        "ratios": {"certified_map_vs_paper": ours / theirs},
        "times": {"certified_map_s": ours, "paper_map_s": theirs, **times},
    }


if __name__ == "__main__":
    asked = parser(__doc__)
    studies = asked.add_subparsers(dest="study")
    study = studies.add_parser("starts")
    study.add_argument("count", nargs="?", type=int, default=10_000)
    study.add_argument("seed", nargs="?", type=int, default=1)
    study.add_argument("file", nargs="?", type=Path)
    studies.add_parser("cells").add_argument("size", nargs="?", type=int, default=31)
    studies.add_parser("measure", help="times, as without a study")
    given = asked.parse_args()
    if given.study == "starts":
        result: Any = starts(given.count, given.seed, given.file)
    elif given.study == "cells":
        result = cells(given.size)
    else:
        result = measure()
    sys.stdout.write(json.dumps(result, indent=2) + "\n")

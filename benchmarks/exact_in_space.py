"""The exact answer in space beside a dense linear program; run as a module, a study of random questions.

``python -m benchmarks.exact_in_space [CASES] [FIRST] [PROOFS]`` draws CASES questions from number FIRST on (torque-free
bodies, spins, tables, circular and elliptic orbits, velocities, faces in LVLH, balls, boxes and hulls of thrusters),
compares every verdict with the program, whose motion and attitude are SciPy's, flies the witnesses of GOs by SciPy,
checks the first PROOFS proofs, and prints one JSON document. Times are of questions never met before: their tables are
made anew.
"""

from __future__ import annotations

import json
import time
from collections import Counter
from statistics import median
from typing import Any

import numpy as np

from benchmarks.asked import parser
from benchmarks.peers.space_cases import dense_margin, drawn, torque_free_case
from benchmarks.peers.space_flight import flown_margin
from safestart.exact.answer import Verdict
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.prove import proof_in_space
from safestart.exact.space.watch import space_watch_of
from safestart.proofs.checker import check

NEAR_M = 0.05
"""Closer to 0 than this the program's samples may decide otherwise than all times do."""


def study(cases: int, first: int, proofs: int) -> dict[str, Any]:
    """Verdicts against the program's, and what the checker says of the proofs."""
    verdicts: Counter[str] = Counter()
    wrong: list[Any] = []
    rejected: list[Any] = []
    compared = checked = flown = 0
    lost_m = 0.0
    spent: list[float] = []
    verify: list[float] = []
    for seed in range(first, first + cases):
        question, state = drawn(seed)
        begin = time.process_time()
        answer = decide_in_space(question, state)
        spent.append(time.process_time() - begin)
        verdicts[answer.verdict.value] += 1
        bounds = dense_margin(question, state, 4)
        inside, outside = bounds[0], bounds[-1]
        go = answer.verdict is Verdict.GO
        if answer.verdict is not Verdict.UNDECIDED:
            compared += inside > NEAR_M or outside < -NEAR_M
            if (inside > NEAR_M and not go) or (outside < -NEAR_M and go) or answer.lower > outside + 1e-5:
                wrong.append([seed, answer.verdict.value, answer.lower, answer.upper, *bounds])
        if go and answer.thrust is not None:
            flown += 1
            thrust = space_watch_of(question).accelerations(answer.thrust)
            lost_m = max(lost_m, answer.lower - flown_margin(question, state, thrust))
        if checked < proofs and answer.verdict is not Verdict.UNDECIDED:
            checked += 1
            document = json.loads(json.dumps(proof_in_space(question, state, answer)))
            begin = time.process_time()
            try:
                check(document)
            except Exception as error:  # a study lists what fails and goes on
                rejected.append([seed, repr(error)])
            verify.append(time.process_time() - begin)
    return {
        "cases": cases,
        "first": first,
        "verdicts": dict(verdicts),
        "compared": compared,
        "other_than_the_program": wrong,
        "witnesses_flown": flown,
        "most_lost_of_a_margin_m": lost_m,
        "proofs_checked": checked,
        "proofs_rejected": rejected,
        "cpu_s": {"median": median(spent), "p99": float(np.percentile(spent, 99))},
        "verify_cpu_s": {"median": median(verify), "most": max(verify)} if verify else None,
    }


def measure(cases: int = 60) -> dict[str, dict[str, float]]:
    """Torque-free questions of 60 s with a ball of thrusts: answer and proof, the program's solve, the checker."""
    spent, dense, verify = [], [], []
    for seed in range(cases):
        question, state = torque_free_case(seed)
        begin = time.process_time()
        answer = decide_in_space(question, state)
        document = proof_in_space(question, state, answer) if answer.verdict is not Verdict.UNDECIDED else {}
        spent.append(time.process_time() - begin)
        if seed < 10:
            times: list[float] = []
            dense_margin(question, state, 4, times)
            dense.append(times[0])
        if document:
            document = json.loads(json.dumps(document))
            begin = time.process_time()
            check(document)
            verify.append(time.process_time() - begin)
    return {
        "ratios": {"exact_3d_vs_lp": median(dense) / median(spent)},
        "times": {
            "exact_in_space_s": median(spent),
            "exact_in_space_p99_s": float(np.percentile(spent, 99)),
            "dense_lp_in_space_s": median(dense),
            "verify_in_space_s": median(verify),
            "verify_in_space_most_s": max(verify),
        },
    }


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("cases", nargs="?", type=int, help="without it: what safestart bench measures")
    asked.add_argument("first", nargs="?", type=int, default=0)
    asked.add_argument("proofs", nargs="?", type=int, default=20)
    given = asked.parse_args()
    found = measure() if given.cases is None else study(given.cases, given.first, given.proofs)
    print(json.dumps(found, indent=1))

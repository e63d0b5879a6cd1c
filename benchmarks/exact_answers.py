"""The exact answer beside the dense linear program; run as a module, the study of 2 000 starts.

``python -m benchmarks.exact_answers [STARTS] [SEED]`` prints one JSON document. Starts are at rest in LVLH, drawn over
the sweep of paper 000's Table 3: a_max 0.02, 0.05, 0.10 m/s^2, 1 to 5 deg/s, ranges 30, 50, 100, 150 m, any angle in
the cone.
"""

from __future__ import annotations

import json
import math
import sys
from collections import Counter
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np

from benchmarks.asked import parser
from benchmarks.peers.dense_lp import DenseLP
from benchmarks.timing import once
from safestart.closed_form.paper import certify
from safestart.exact.answer import Answer, Verdict
from safestart.exact.decide import decide
from safestart.exact.prove import proof_of
from safestart.exact.question import Question
from safestart.model.scenario import Floats, Scenario
from safestart.proofs.single import check

THRUSTS, RATES, RANGES = (0.02, 0.05, 0.10), (1.0, 2.0, 3.0, 4.0, 5.0), (30.0, 50.0, 100.0, 150.0)
NEAR_M = 0.05
"""Closer to 0 than this the program's samples, 0.5 s apart, may decide otherwise than all times do."""

MEASURED = 100


@dataclass
class Case:
    """One start with its results in metres and its times in seconds."""

    question: Question
    state: Floats
    answer: Answer
    proof: dict[str, Any]
    inner: float
    outer: float
    exact_s: float
    dense_s: float
    verify_s: float


def draw(count: int, seed: int) -> list[tuple[Question, Floats]]:
    """Questions and starts (4,) at rest in LVLH, inside the corridor."""
    rng = np.random.default_rng(seed)
    out: list[tuple[Question, Floats]] = []
    while len(out) < count:
        scenario = Scenario.of(float(rng.choice(RATES)), float(rng.choice(THRUSTS)))
        angle, radius = rng.uniform(-1.0, 1.0) * math.atan(1.5), float(rng.choice(RANGES))
        state = np.array([radius * math.sin(angle), radius * math.cos(angle), 0.0, 0.0])
        out.append((Question(scenario), state))
    return out


def run(count: int, seed: int, *, verify: bool = True) -> list[Case]:
    """Every start answered, proved, checked, and solved by the dense program, one after another in turn."""
    programs: dict[Scenario, tuple[DenseLP, DenseLP]] = {}
    cases = []
    for question, state in draw(count, seed):
        if question.scenario not in programs:
            programs[question.scenario] = (
                DenseLP(question.scenario),
                DenseLP(question.scenario, outer=True),
            )
            # Both sides cache values that depend only on the scenario, and neither counts the time for them.
            decide(question, state)
        inner, outer = programs[question.scenario]
        found: dict[str, Any] = {}

        def ours(question: Question = question, state: Floats = state, found: dict[str, Any] = found) -> None:
            found["answer"] = decide(question, state)
            if found["answer"].verdict is not Verdict.UNDECIDED:
                found["proof"] = proof_of(question, state, found["answer"])

        def dense(inner: DenseLP = inner, state: Floats = state, found: dict[str, Any] = found) -> None:
            found["inner"] = inner.margin(state)

        exact_s, dense_s = once(ours), once(dense)
        proof = found.get("proof", {})
        verify_s = once(lambda proof=proof: check(proof)) if verify and proof else math.nan
        cases.append(
            Case(
                question,
                state,
                found["answer"],
                proof,
                found["inner"],
                outer.margin(state) if verify else math.nan,
                exact_s,
                dense_s,
                verify_s,
            )
        )
    return cases


def disagreements(cases: list[Case]) -> list[Case]:
    """Cases whose verdict the program contradicts: its polygons bracket the disk, its samples add up to ``NEAR_M``.

    A GO must be feasible with the polygon around the disk, a NO_GO infeasible with the polygon inside it.
    """
    return [
        case
        for case in cases
        if (case.answer.verdict is Verdict.GO and case.outer < -1e-6)
        or (case.answer.verdict is Verdict.NO_GO and case.inner > NEAR_M)
        or case.answer.lower > case.outer + 1e-6
        or case.answer.upper < case.inner - NEAR_M
    ]


def one_sided(cases: list[Case]) -> list[Case]:
    """Cases where the sign of the program's own margin (polygon inside) differs from ours, beyond ``NEAR_M``."""
    return [
        case
        for case in cases
        if case.answer.verdict is not Verdict.UNDECIDED
        and abs(case.answer.margin_m) > NEAR_M
        and (case.inner > 0.0) != (case.answer.verdict is Verdict.GO)
    ]


def certified(case: Case) -> bool:
    """Whether the closed form certifies the case's start."""
    return bool(certify(case.question.scenario, case.state[:2]).safe)


def study(count: int, seed: int) -> dict[str, Any]:
    """Figures over many starts."""
    cases = run(count, seed)
    exact = np.array([case.exact_s for case in cases])
    verdicts = Counter(case.answer.verdict.value for case in cases)
    refused = [c for c in cases if certified(c) and c.answer.verdict is Verdict.NO_GO]
    return {
        "starts": count,
        "seed": seed,
        "verdicts": dict(verdicts),
        "undecided_share": verdicts["UNDECIDED"] / count,
        "proofs_verified": sum(1 for case in cases if not math.isnan(case.verify_s)),
        "disagreements_with_bracket": len(disagreements(cases)),
        "other_sign_than_inner_polygon": [
            [case.answer.margin_m, case.inner, case.outer] for case in one_sided(cases)
        ],
        "closed_form_go": sum(certified(case) for case in cases),
        "closed_form_go_refused": [
            [
                math.degrees(c.question.scenario.target.tumble_rate),
                c.question.scenario.chaser.max_acceleration,
                *c.state[:2].tolist(),
                c.answer.margin_m,
            ]
            for c in refused
        ],
        "exact_go_not_certified": sum(c.answer.verdict is Verdict.GO and not certified(c) for c in cases),
        "widest_gap_m": max(case.answer.gap for case in cases if case.answer.iterations),
        "rounds": {
            "mean": float(np.mean([c.answer.iterations for c in cases])),
            "most": max(c.answer.iterations for c in cases),
        },
        "exact_s": {"median": float(np.median(exact)), "p99": float(np.percentile(exact, 99))},
        "dense_lp_s": {"median": median(case.dense_s for case in cases)},
        "ratio_of_medians": median(c.dense_s for c in cases) / float(np.median(exact)),
        "verify_s": {
            verdict: median(c.verify_s for c in cases if c.answer.verdict.value == verdict)
            for verdict in ("GO", "NO_GO")
            if verdicts[verdict]
        },
    }


def measure() -> dict[str, dict[str, float]]:
    """Median and p99 of answer and proof, of the dense program's solve, and of the checker, over 100 starts."""
    cases = run(MEASURED, 1)
    exact = [case.exact_s for case in cases]
    dense = median(case.dense_s for case in cases)
    return {
        "ratios": {"exact_vs_lp": dense / median(exact)},
        "times": {
            "exact_answer_s": median(exact),
            "exact_answer_p99_s": float(np.percentile(exact, 99)),
            "dense_lp_s": dense,
            "verify_s": median(case.verify_s for case in cases),
        },
    }


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("starts", nargs="?", type=int, default=2000)
    asked.add_argument("seed", nargs="?", type=int, default=1)
    given = asked.parse_args()
    sys.stdout.write(json.dumps(study(given.starts, given.seed), indent=2) + "\n")

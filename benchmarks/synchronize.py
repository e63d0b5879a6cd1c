"""Synchronize within 200 s over the sweep of paper 000's Table 3; run as a module, the study.

``python -m benchmarks.synchronize [STARTS] [SEED]`` prints one JSON document. Starts are at rest in LVLH, drawn as in
:mod:`benchmarks.exact_answers`. Every answer is proved and checked, the first 40 witnesses are
flown by DOP853. Twice: with the default hold point (0, r_h), and with (0, 2 m), the end of the closed-loop approach.
"""

from __future__ import annotations

import json
import math
import sys
from collections import Counter
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.asked import parser
from benchmarks.exact_answers import draw
from benchmarks.peers.flown import fly
from safestart.closed_form.paper import certify
from safestart.exact.answer import Answer, Verdict
from safestart.exact.decide import decide
from safestart.exact.prove import proof_of
from safestart.exact.question import Goal, Question
from safestart.model.scenario import Floats
from safestart.proofs.single import check

STEPS, FLOWN = 100, 40
GOALS = {"(0, r_h)": Goal(), "(0, 2 m)": Goal(hold=(0.0, 2.0))}


@dataclass
class Case:
    """One start with its answers (including whether it stays for 200 s) and their times in seconds."""

    question: Question
    state: Floats
    certified: bool
    answer: Answer
    stays: Verdict
    answer_s: float
    verify_s: float
    document_bytes: int
    flown_error_m: float


def run(count: int, seed: int, goal: Goal) -> list[Case]:
    """Every start answered, proved, checked and flown."""
    cases: list[Case] = []
    flown = 0
    for base, state in draw(count, seed):
        question = replace(base, steps=STEPS, goal=goal)
        begin = perf_counter()
        answer = decide(question, state)
        document = None if answer.verdict is Verdict.UNDECIDED else proof_of(question, state, answer)
        taken = perf_counter() - begin
        begin = perf_counter()
        if document is not None:
            check(document)
        verify_s = perf_counter() - begin
        error = math.nan
        if answer.verdict is Verdict.GO and answer.thrust is not None and flown < FLOWN:
            flown += 1
            error = abs(fly(question, state, answer.thrust) - answer.margin_m)
        cases.append(
            Case(
                question,
                state,
                bool(certify(question.scenario, state[:2]).safe),
                answer,
                decide(replace(question, goal=None), state, verdict_only=True).verdict,
                taken,
                verify_s,
                len(json.dumps(document)),
                error,
            )
        )
    return cases


def study(cases: list[Case]) -> dict[str, Any]:
    """Figures over the cases of one goal."""
    counts = Counter(
        f"{'' if c.certified else 'not '}certified, stay 200 s {c.stays.value}, synchronize {c.answer.verdict.value}"
        for c in cases
    )
    refused = [c for c in cases if c.certified and c.answer.verdict is not Verdict.GO]
    times = np.array([c.answer_s for c in cases])
    return {
        "counts": dict(sorted(counts.items())),
        "certified": sum(c.certified for c in cases),
        "certified_not_go": [
            [
                math.degrees(c.question.scenario.target.tumble_rate),
                c.question.scenario.chaser.max_acceleration,
                *c.state[:2].tolist(),
                c.answer.verdict.value,
                c.answer.margin_m,
                c.stays.value,
            ]
            for c in refused
        ],
        "answer_and_proof_s": {
            "median": float(np.median(times)),
            "p99": float(np.percentile(times, 99)),
            "most": float(times.max()),
        },
        "verify_s": {
            "median": float(np.median([c.verify_s for c in cases])),
            "most": max(c.verify_s for c in cases),
        },
        "programs_solved": {
            "mean": float(np.mean([c.answer.iterations for c in cases])),
            "most": max(c.answer.iterations for c in cases),
        },
        "parts_most": max(len(c.answer.parts) for c in cases),
        "document_bytes": {
            "median": float(np.median([c.document_bytes for c in cases])),
            "most": max(c.document_bytes for c in cases),
        },
        "flown_error_m": float(np.nanmax([c.flown_error_m for c in cases])),
    }


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("starts", nargs="?", type=int, default=1000)
    asked.add_argument("seed", nargs="?", type=int, default=1)
    given = asked.parse_args()
    found = {name: study(run(given.starts, given.seed, goal)) for name, goal in GOALS.items()}
    said = {"starts": given.starts, "seed": given.seed, "goals": found}
    sys.stdout.write(json.dumps(said, indent=2) + "\n")

"""Verdicts for families: counts, time to the verdict and of the checker, random members of each asked alone.

``python -m benchmarks.for_all [STARTS] [SEED] [DIMENSIONS] [common|per_corner]`` prints one JSON document. Starts as in
``benchmarks.exact_answers``; half-widths 1 % of the tumble rate, 2 % of the thrust, 0.1 % of the mean motion, 0.5 m and
0.02 m/s.
"""

from __future__ import annotations

import json
import sys
from collections import Counter, defaultdict
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.asked import parser
from benchmarks.exact_answers import draw
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.exact.question import Question
from safestart.exact.watch import Watch
from safestart.families.answer import ForAll, Witness
from safestart.families.decide import decide_for_all
from safestart.families.members import Family
from safestart.families.prove import proof_for_all
from safestart.model.scenario import Floats
from safestart.proofs.checker import check

MEMBERS = 20


def family_of(question: Question) -> Family:
    """The half-widths of the study."""
    target, chaser, d = question.scenario.target, question.scenario.chaser, question.dimensions
    return Family(
        question,
        0.01 * target.tumble_rate,
        0.02 * chaser.max_acceleration,
        0.001 * target.mean_motion,
        (0.5,) * d + (0.02,) * d,
    )


def contradicted(family: Family, state: Floats, answer: ForAll, rng: np.random.Generator) -> int:
    """How many of some random members, each asked alone, contradict the answer."""
    wrong = 0
    for _ in range(MEMBERS):
        low, high = np.array([family.rates, family.motions, family.thrusts]).T
        rate, motion, thrust = rng.uniform(low, high).tolist()
        start = state + family.half * rng.choice([-1.0, -0.5, 0.0, 0.7, 1.0], len(state))
        member = family.member(rate, motion, thrust)
        if answer.verdict is Verdict.GO and answer.witness == "common":
            flown = Watch(member).minima(start, answer.histories[0].thrust)
            wrong += float(flown.values.min()) < answer.margin_m
        else:
            wrong += decide(member, start, verdict_only=True).verdict is not answer.verdict
    return wrong


def study(count: int, seed: int, dimensions: int, witness: Witness) -> dict[str, Any]:
    """The study as one document; times in seconds."""
    rng = np.random.default_rng(seed)
    verdicts: Counter[str] = Counter()
    taken, checked, alone = defaultdict(list), defaultdict(list), []
    wrong = differ = middles = 0
    for question, planar in draw(count, seed):
        if dimensions == 3:
            question, planar = _in_space(question, planar, rng)
        family = family_of(question)
        begin = perf_counter()
        answer = decide_for_all(family, planar, witness=witness)
        taken[answer.verdict.value].append(perf_counter() - begin)
        verdicts[answer.verdict.value] += 1
        begin = perf_counter()
        middle = decide(question, planar)
        alone.append(perf_counter() - begin)
        if answer.verdict is Verdict.UNDECIDED:
            differ += len(answer.examples) == 2
            continue
        proof = proof_for_all(family, planar, answer)
        begin = perf_counter()
        check(proof)
        checked[answer.verdict.value].append(perf_counter() - begin)
        wrong += contradicted(family, planar, answer, rng)
        middles += middle.verdict is not answer.verdict
    return {
        "starts": count,
        "dimensions": dimensions,
        "witness": witness,
        "verdicts": dict(verdicts),
        "undecided_with_two_members_that_differ": differ,
        "proofs_verified": sum(len(times) for times in checked.values()),
        "members_that_contradict": wrong,
        "middles_that_contradict": middles,
        "one_start_s": _spread(alone),
        "answer_s": {name: _spread(times) for name, times in taken.items()},
        "verify_s": {name: _spread(times) for name, times in checked.items()},
    }


def _in_space(question: Question, planar: Floats, rng: np.random.Generator) -> tuple[Question, Floats]:
    z = 0.3 * planar[1] * rng.uniform(-1.0, 1.0)
    return (
        Question(question.scenario, question.dt, question.steps, 3),
        np.array([planar[0], planar[1], z, 0.0, 0.0, 0.0]),
    )


def _spread(times: list[float]) -> dict[str, float]:
    return {"median": median(times), "p99": float(np.percentile(times, 99)), "most": max(times)}


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("starts", nargs="?", type=int, default=200)
    asked.add_argument("seed", nargs="?", type=int, default=1)
    asked.add_argument("dimensions", nargs="?", type=int, default=2)
    asked.add_argument("witness", nargs="?", choices=("common", "per_corner"), default="common")
    given = asked.parse_args()
    found = study(given.starts, given.seed, given.dimensions, given.witness)
    sys.stdout.write(json.dumps(found, indent=2) + "\n")

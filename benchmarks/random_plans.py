"""Random plans: does a flight about the true Earth ever violate what was PROVED, and what would sampling have missed?

``python -m benchmarks.random_plans 10000`` (``--first 1000``: from that plan on) draws plans of one to four impulses
near a target, on orbits of any inclination, and proves each about the true Earth (``earth``), for missed, partial,
late, stuck and misdirected burns. PROVED plans are flown with errors and failures at their limits about the true Earth
with J2. VIOLATED ones are replayed and sampled every 60 s: the drifts after every burn as planned, and the
counter-example's own drift.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from multiprocessing import get_context
from typing import Any

import numpy as np

from safestart.dynamics.cwh import transition_matrix
from safestart.dynamics.two_body_kernel import STAGES, WEIGHTS, drifted, placed, pushed
from safestart.hopping.approach import mean_motion_of
from safestart.missed_burn.earth.motion import Earth, target_before
from safestart.missed_burn.plan import Burn, Errors, Failures, Plan, Question
from safestart.missed_burn.prove import Proof, Verdict, prove
from safestart.model.scenario import Floats

AXIS = 8.1e6
N = mean_motion_of(AXIS)
ORBIT = math.tau / N
KEEP_OUT = 30.0
SAMPLE = 60.0
ERRORS = Errors((0.5,) * 3, (1e-3,) * 3, 0.01, math.radians(0.5))
FAILURES = Failures(60.0, True, 5.0, 0.002, math.radians(5.0))
FLIGHTS = 12
PART = 50
COUNTED = (
    *("PROVED", "VIOLATED", "UNKNOWN", "flights", "proved_but_violated", "replayed"),
    *("missed_by_sampling_as_planned", "missed_between_samples_of_the_violation"),
)
_PULSES = 40


def plan_of(rng: np.random.Generator) -> Plan:
    """One to four impulses of a few cm/s to dm/s from a point 100 to 500 m away."""
    burns, now = [], 0.0
    for _ in range(int(rng.integers(1, 5))):
        x, y, z = rng.normal(0.0, 0.1, 3).tolist()
        burns.append(Burn(now, (x, y, z)))
        now += float(rng.uniform(200.0, 4000.0))
    at = rng.standard_normal(3)
    at *= rng.uniform(100.0, 500.0) / np.linalg.norm(at)
    return Plan(N, (*at.tolist(), *rng.normal(0.0, 0.05, 3).tolist()), tuple(burns))


def question_of(rng: np.random.Generator) -> Question:
    """A plan about the true Earth, over 0.3 to 2 orbits, on an orbit of any inclination, up to e = 0.02."""
    plan = plan_of(rng)
    horizon = float(rng.uniform(0.3, 2.0)) * ORBIT
    shape, tilt, perigee, anomaly = rng.uniform([0.0, 0.0, 0.0, 0.0], [0.02, math.pi, math.tau, math.tau])
    earth = Earth.of(plan, AXIS, float(shape), float(tilt), float(perigee), float(anomaly))
    return Question(plan, KEEP_OUT, horizon, ERRORS, FAILURES, earth=earth)


def flown(question: Question, rng: np.random.Generator) -> float:
    """Least distance, m, of a flight about the true Earth: one burn with one failure, errors at or within limits."""
    plan, errors, failures = question.plan, question.errors, question.failures
    k = int(rng.integers(-1, len(plan.burns)))
    kind = "start" if k < 0 else str(rng.choice(["made", "partial", "late", "stuck", "misdirected"]))
    first = max(k, 0)
    box = np.array([*errors.position, *errors.velocity])
    size = rng.choice([-1.0, 1.0], 6) if rng.random() < 0.7 else rng.uniform(-1.0, 1.0, 6)
    flight = placed(target_before(question, first), question.before()[first] + size * box)
    least = float(np.linalg.norm(flight[6:9]))

    def wait(seconds: float) -> None:
        nonlocal flight, least
        flight, near = drifted(flight, seconds, STAGES, WEIGHTS)
        least = min(least, near)

    if kind == "start":
        wait(question.horizon)
        return least
    burn, share = plan.burns[k], 1.0 + errors.thrust_share * rng.choice([-1.0, 1.0])
    angle = errors.thrust_angle + (failures.misdirected if kind == "misdirected" else 0.0)
    impulse = (
        (rng.random() if kind == "partial" else 1.0) * share * turned(np.array(burn.impulse), angle, rng)
    )
    if kind == "late":
        wait(failures.late * float(rng.choice([1.0, rng.random()])))
    pushed(flight, impulse)
    if kind == "stuck":
        on = failures.stuck * float(rng.choice([1.0, rng.random()])) / _PULSES
        push = failures.acceleration / burn.size * impulse
        for _ in range(_PULSES):
            wait(0.5 * on)
            pushed(flight, on * push)
            wait(0.5 * on)
    wait(question.horizon)
    return least


def turned(v: Floats, angle: float, rng: np.random.Generator) -> Floats:
    """A vector turned by an angle to a random side."""
    across = np.cross(v, rng.standard_normal(3))
    across /= np.linalg.norm(across)
    out: Floats = math.cos(angle) * v + math.sin(angle) * np.linalg.norm(v) * across
    return out


def sampled(question: Question, every: float = SAMPLE) -> float:
    """Least distance, m, that sampling finds: drifts after every burn as planned, CWH, at equal times."""
    times = np.arange(0.0, question.horizon, every)
    rows = np.array([transition_matrix(N, float(t))[:3] for t in times])
    states = [question.before()[0]]
    for state, burn in zip(question.before(), question.plan.burns, strict=True):
        after = state.copy()
        after[3:] += burn.impulse
        states.append(after)
    return min(float(np.linalg.norm(rows @ state, axis=1).min()) for state in states)


def replayed(question: Question, proof: Proof) -> bool:
    """Whether the counter-example enters."""
    return proof.counter_example is not None and proof.counter_example.distance() < question.keep_out


def one(number: int, seed: int = 0) -> tuple[Counter[str], float]:
    """Counts of one plan, and by how much its flights kept more than was proved, m (infinite: not PROVED)."""
    rng = np.random.default_rng((seed, number))
    question = question_of(rng)
    proof = prove(question, sharp=False)
    found, slack = Counter({proof.verdict.value: 1}), math.inf
    if proof.verdict is Verdict.PROVED:
        near = min(flown(question, rng) for _ in range(FLIGHTS))
        found["flights"] = FLIGHTS
        found["proved_but_violated"] = int(near < question.keep_out)
        slack = near - proof.least
    if proof.verdict is Verdict.VIOLATED:
        found["replayed"] = int(replayed(question, proof))
        found["missed_by_sampling_as_planned"] = int(sampled(question) >= question.keep_out)
        found["missed_between_samples_of_the_violation"] = int(seen_every(proof) >= question.keep_out)
    return found, slack


def part(numbers: range, seed: int = 0) -> tuple[Counter[str], float]:
    """Counts of several plans, and the least slack."""
    found: Counter[str] = Counter()
    slack = math.inf
    for number in numbers:
        counts, kept = one(number, seed)
        found, slack = found + counts, min(slack, kept)
    return found, slack


def study(
    count: int,
    seed: int = 0,
    first: int = 0,
    cores: int = 1,
    tell: Callable[[dict[str, Any]], None] | None = None,
) -> dict[str, Any]:
    """Counts over plans ``first`` to ``first + count``: verdicts, PROVED ones that a flight violates, VIOLATED ones
    that sampling misses. ``tell`` gets them after every part of 50."""
    cut = [range(k, min(k + PART, first + count)) for k in range(first, first + count, PART)]
    found: Counter[str] = Counter(dict.fromkeys(COUNTED, 0))
    slack, done = math.inf, 0
    said: dict[str, Any] = {}
    with ProcessPoolExecutor(cores, get_context("spawn")) as pool:
        # In order: what is told is about the first plans, without gaps.
        for numbers, (counts, kept) in zip(cut, pool.map(partial(part, seed=seed), cut), strict=True):
            found.update(counts)
            slack, done = min(slack, kept), done + len(numbers)
            said = {"first": first, "plans": done, "seed": seed, **found, "least_slack_m": slack}
            if tell is not None:
                tell(said)
    return said


def seen_every(proof: Proof, every: float = SAMPLE) -> float:
    """Least distance, m, of the counter-example's own flight looked at every so many seconds from its last burn on."""
    made = proof.counter_example
    assert made is not None
    now = float(made.times.max(initial=made.begin))
    flight = replace(made, look=now).earth_flight()
    least = float(np.linalg.norm(flight[6:9]))
    # While its thrust is on it is flown anew for each look; from there on it only drifts.
    thrust_ends = now + made.push_for
    while now < made.look:
        now += every
        if now - every < thrust_ends:
            flight = replace(made, look=now).earth_flight()
        else:
            flight, _ = drifted(flight, every, STAGES, WEIGHTS)
        least = min(least, float(np.linalg.norm(flight[6:9])))
    return least


def main() -> None:
    """Study and print, a line for every part."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("plans", type=int, nargs="?", default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="Number of the first plan.")
    parser.add_argument("--cores", type=int, default=2)
    given = parser.parse_args()
    begin = time.perf_counter()

    def tell(said: dict[str, Any]) -> None:
        print(json.dumps({**said, "seconds": round(time.perf_counter() - begin, 1)}), flush=True)

    study(given.plans, given.seed, given.first, given.cores, tell)


if __name__ == "__main__":
    main()

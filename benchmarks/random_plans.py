"""Random plans: does a flight about the true Earth ever violate what was PROVED, and what would sampling have missed?

``python -m benchmarks.random_plans 1000`` draws plans of one to four impulses near a target, on orbits of any
inclination, and proves each about the true Earth (``earth``), for missed, partial, late, stuck and misdirected burns.
PROVED plans are flown with errors and failures at their limits about the true Earth with J2. VIOLATED ones are replayed
and sampled every 60 s: the drifts after every burn as planned, and the counter-example's own drift.
"""

from __future__ import annotations

import argparse
import json
import math
from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np

from safestart.dynamics.cwh import transition_matrix
from safestart.dynamics.two_body_kernel import STAGES, WEIGHTS, drifted, placed, pushed
from safestart.hopping.approach import mean_motion_of
from safestart.missed_burn.earth import Earth, target_before
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


def study(count: int, seed: int = 0) -> dict[str, Any]:
    """Counts over plans: verdicts, PROVED ones that a flight violates, VIOLATED ones that sampling misses."""
    found: Counter[str] = Counter()
    slack = math.inf
    for number in range(count):
        rng = np.random.default_rng((seed, number))
        question = question_of(rng)
        proof = prove(question, sharp=False)
        found[proof.verdict.value] += 1
        if proof.verdict is Verdict.PROVED:
            near = min(flown(question, rng) for _ in range(FLIGHTS))
            found["flights"] += FLIGHTS
            found["proved_but_violated"] += near < question.keep_out
            slack = min(slack, near - proof.least)
        if proof.verdict is Verdict.VIOLATED:
            found["replayed"] += replayed(question, proof)
            found["missed_by_sampling_as_planned"] += sampled(question) >= question.keep_out
            found["missed_between_samples_of_the_violation"] += seen_every(proof) >= question.keep_out
    return {"plans": count, "seed": seed, **dict(sorted(found.items())), "least_slack_m": slack}


def seen_every(proof: Proof, every: float = SAMPLE) -> float:
    """Least distance, m, of the counter-example's own flight looked at every so many seconds from its last burn on."""
    flight = proof.counter_example
    assert flight is not None
    looks = np.arange(flight.times.max(initial=flight.begin), flight.look + every, every)
    return min(replace(flight, look=look).distance() for look in looks.tolist())


def main() -> None:
    """Study and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("plans", type=int, nargs="?", default=1000)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    print(json.dumps(study(given.plans, given.seed), indent=1))


if __name__ == "__main__":
    main()

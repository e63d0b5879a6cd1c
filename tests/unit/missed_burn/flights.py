"""Random physical flights within a question's limits, without use of the sets."""

import math

import numpy as np

from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.hopping.approach import approach, mean_motion_of
from safestart.missed_burn.plan import Errors, Failures, Plan, Question

N = mean_motion_of(8.1e6)
ORBIT = math.tau / N
STUDY = Errors((0.5, 0.5, 0.5), (1e-3, 1e-3, 1e-3), 0.01, math.radians(0.5))


def plan_of(angle: float, hops: int = 5, hold: float = 100.0) -> Plan:
    made = approach(N, angle, 2000.0, hold, hops)
    return Plan.of(N, made.states()[0].tolist(), made.times.tolist(), made.impulses)


def turned(v, angle, rng, outermost):
    """A vector turned by at most an angle, often by all of it."""
    if not v.any():
        return v
    by = angle if rng.random() < outermost else angle * math.sqrt(rng.random())
    across = np.cross(v, rng.standard_normal(3))
    across /= np.linalg.norm(across)
    return math.cos(by) * v + math.sin(by) * np.linalg.norm(v) * across


def drawn(question: Question, kind: str, burn: int, rng, outermost: float = 0.7):
    """State (6,) from which a case drifts, referred to the time when it begins to drift, and that time, s."""
    plan, errors, failures = question.plan, question.errors, question.failures
    n, box = plan.mean_motion, np.array([*errors.position, *errors.velocity])

    def corner(size):
        return size * (
            rng.choice([-1.0, 1.0], len(size)) if rng.random() < outermost else rng.uniform(-1, 1, len(size))
        )

    first = max(burn, 0) if errors.at_each_burn else 0
    state, now = plan.before()[first] + corner(box), plan.burns[first].time
    if kind == "start":
        return state, now
    for k in range(first, burn + 1):
        at = plan.burns[k].time
        share = 1.0 + corner(np.array([errors.thrust_share]))[0]
        angle = errors.thrust_angle
        if k == burn and kind == "partial":
            share *= rng.choice([0.0, 1.0, rng.random()])
        if k == burn and kind == "late":
            at += rng.choice([failures.late, failures.late * rng.random()])
        impulse = turned(share * np.array(plan.burns[k].impulse), angle, rng, outermost)
        if k == burn and kind == "misdirected":
            impulse = turned(impulse, failures.misdirected, rng, outermost)
        state = transition_matrix(n, at - now) @ state
        state[3:] += impulse
        now = at
    if kind == "stuck":
        on = failures.stuck * rng.choice([1.0, rng.random()])
        push = failures.acceleration / np.linalg.norm(plan.burns[burn].impulse) * impulse
        state = transition_matrix(n, on) @ state + input_matrix(n, on) @ push
        now += on
    return state, now


def distances(n, state, times):
    """Distances of a free drift at times after now."""
    tau = n * times
    s, c = np.sin(tau), np.cos(tau)
    x, y, z, u, v, w = state
    radial = (4 - 3 * c) * x + s / n * u + 2 * (1 - c) / n * v
    along = 6 * (s - tau) * x + y - 2 * (1 - c) / n * u + (4 * s - 3 * tau) / n * v
    return np.sqrt(radial**2 + along**2 + (c * z + s / n * w) ** 2)


EVERYTHING = Failures(60.0, True, 5.0, 0.002, math.radians(5.0))

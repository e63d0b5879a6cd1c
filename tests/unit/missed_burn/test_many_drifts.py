"""A hundred thousand random failures of one burn: every state lies in its case's set, every drift keeps its bound."""

import math

import numpy as np
import pytest

from safestart.missed_burn.cases import cases_of
from safestart.missed_burn.plan import Failures, Question
from safestart.missed_burn.prove import bound
from tests.unit.missed_burn.flights import ORBIT, STUDY, N, plan_of

FAILURES = Failures(40.0, True, 5.0, 0.002, math.radians(5.0))
EACH = 20_000
KINDS = ("made", "partial", "misdirected", "late", "stuck")
BURN = 4


def _transitions(t):
    """CWH transition (T, 6, 6) over times (T,), also negative."""
    s, c, one = np.sin(N * t), np.cos(N * t), np.ones_like(t)
    phi = np.zeros((len(t), 6, 6))
    phi[:, 0, 0], phi[:, 0, 3], phi[:, 0, 4] = 4 - 3 * c, s / N, 2 * (1 - c) / N
    phi[:, 1, 0], phi[:, 1, 1] = 6 * (s - N * t), one
    phi[:, 1, 3], phi[:, 1, 4] = -2 * (1 - c) / N, (4 * s - 3 * N * t) / N
    phi[:, 2, 2], phi[:, 2, 5] = c, s / N
    phi[:, 3, 0], phi[:, 3, 3], phi[:, 3, 4] = 3 * N * s, c, 2 * s
    phi[:, 4, 0], phi[:, 4, 3], phi[:, 4, 4] = -6 * N * (1 - c), -2 * s, 4 * c - 3
    phi[:, 5, 2], phi[:, 5, 5] = -N * s, c
    return phi


def _thrusts(impulse, least, angle, rng):
    """Vectors (EACH, 3) of a piece of a shell, half of them on its edge."""
    size = np.linalg.norm(impulse)
    along = impulse / size
    across = np.cross(along, rng.standard_normal((EACH, 3)))
    across /= np.linalg.norm(across, axis=1)[:, None]
    edge = rng.random(EACH) < 0.5
    by = angle * np.where(edge, 1.0, rng.random(EACH))
    share = rng.uniform(least, 1.01, EACH)
    share[edge] = rng.choice([least, 1.01], EACH)[edge]
    return size * share[:, None] * (np.cos(by)[:, None] * along + np.sin(by)[:, None] * across)


def _drawn(question, kind, rng):
    """States (EACH, 6) at the planned time of the burn and the time (EACH,) by which it is late or goes on."""
    errors, burn = question.errors, question.plan.burns[BURN]
    box = np.array([*errors.position, *errors.velocity])
    states = question.before()[BURN] + box * np.where(
        rng.random((EACH, 6)) < 0.5, rng.choice([-1.0, 1.0], (EACH, 6)), rng.uniform(-1.0, 1.0, (EACH, 6))
    )
    angle = errors.thrust_angle + (FAILURES.misdirected if kind == "misdirected" else 0.0)
    thrust = _thrusts(np.array(burn.impulse), 0.0 if kind == "partial" else 0.99, angle, rng)
    if kind == "late":
        by = FAILURES.late * rng.random(EACH)
        return states + (_transitions(-by)[:, :, 3:] @ thrust[..., None])[..., 0], by
    states[:, 3:] += thrust
    if kind == "stuck":
        by = FAILURES.stuck * rng.random(EACH)
        # The push goes on for a time: its integral by Gauss' rule of three points, exact to 1e-12 here.
        push = FAILURES.acceleration / burn.size * thrust
        for node, weight in ((-math.sqrt(0.6), 5 / 18), (0.0, 8 / 18), (math.sqrt(0.6), 5 / 18)):
            at = _transitions(-by * 0.5 * (1.0 + node))[:, :, 3:]
            states += weight * by[:, None] * (at @ push[..., None])[..., 0]
        return states, by
    return states, np.zeros(EACH)


@pytest.mark.parametrize("angle", [40.0, 90.0])
def test_a_hundred_thousand_drifts_lie_in_their_sets_and_keep_their_bounds(angle: float) -> None:
    question = Question(plan_of(angle), 50.0, 2.0 * ORBIT, STUDY, FAILURES)
    rng, cases = np.random.default_rng(12), cases_of(question)
    rows = _transitions(np.linspace(0.0, 2.0 * ORBIT, 80))[:, :3]
    # In units in which all six are of like size.
    directions = rng.standard_normal((60, 6)) * np.repeat([1.0, 1.0 / N], 3)
    drifts, tight = 0, math.inf
    for kind in KINDS:
        states, by = _drawn(question, kind, rng)
        for case in cases:
            if case.kind != kind or case.burn != BURN:
                continue
            mine = states[(by >= case.first) & ((by < case.last) | (by == case.first))]
            drifts += len(mine)
            images = directions @ case.columns.T
            begins = [0, *case.ends[:-1].tolist()]
            spread = np.sqrt(np.add.reduceat(images**2, begins, axis=1)).sum(axis=1)
            beyond = (mine - case.centre) @ directions.T - spread
            assert beyond.max() <= 1e-9 * np.abs(directions).max(), (kind, case.first)
            tight = min(tight, float(-beyond.max() / spread.max()))
            kept = bound(case, question, math.inf).least
            for t in range(0, len(rows), 8):
                there = np.einsum("tij,sj->tsi", rows[t : t + 8], mine)
                assert np.linalg.norm(there, axis=2).min() >= kept, (kind, case.first)
    assert drifts == EACH * len(KINDS)
    assert tight < 0.2

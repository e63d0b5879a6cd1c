"""The missed-burn proof: no flight beats a bound, bounds are close, the study's levels, counter-examples replay."""

import math
from itertools import product

import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.missed_burn.cases import cases_of
from safestart.missed_burn.plan import Burn, Errors, Failures, Plan, Question
from safestart.missed_burn.prove import Verdict, bound, greatest_scale, prove
from tests.unit.missed_burn.flights import EVERYTHING, ORBIT, STUDY, N, distances, drawn, plan_of


@pytest.mark.parametrize("anew", [True, False])
@pytest.mark.parametrize("angle", [0.0, 40.0, 120.0])
def test_no_flight_comes_nearer_than_its_case_allows(angle: float, anew: bool) -> None:
    errors = Errors(STUDY.position, STUDY.velocity, STUDY.thrust_share, STUDY.thrust_angle, anew)
    question = Question(plan_of(angle), 50.0, 2.0 * ORBIT, errors, EVERYTHING)
    proof = prove(question)
    least: dict[tuple[str, int], float] = {}
    for finding in proof.findings:
        key = finding.case.kind, finding.case.burn
        least[key] = min(least.get(key, math.inf), finding.least)
    rng = np.random.default_rng(11)
    times = np.linspace(0.0, 1.9 * ORBIT, 700)
    close = {}
    for (kind, burn), kept in least.items():
        for _ in range(30):
            state, _ = drawn(question, kind, burn, rng)
            nearest = distances(N, state, times).min()
            assert nearest >= kept
            close[kind] = min(close.get(kind, math.inf), nearest - kept)
    # The bounds are not empty: flights come near them.
    if anew:
        assert close["made"] < 10.0


@pytest.mark.parametrize("angle", [40.0, 90.0])
def test_vertices_of_the_box_come_within_3_m_of_the_bound(angle: float) -> None:
    question = Question(plan_of(angle), 50.0, 2.0 * ORBIT, STUDY)
    case = next(c for c in cases_of(question) if c.kind == "made" and c.burn == 4)
    kept = bound(case, question, math.inf).least
    times = np.linspace(0.0, 2.0 * ORBIT, 3000)
    segments = [case.columns[j] for j in range(len(case.columns)) if case.labels[j][0] != "across"]
    discs = [case.columns[j] for j in range(len(case.columns)) if case.labels[j][0] == "across"]
    near = math.inf
    for signs in product((-1.0, 1.0), repeat=len(segments)):
        corner = case.centre + np.array(signs) @ np.array(segments)
        for turn in np.linspace(0.0, math.tau, 8, endpoint=False):
            state = corner + math.cos(turn) * discs[0] + math.sin(turn) * discs[1]
            near = min(near, distances(N, state, times).min())
    assert kept <= near <= kept + 3.0


LEVELS = [(0.0, 0.59), (20.0, 3.5), (40.0, 5.7), (60.0, 7.3), (90.0, 9.3), (120.0, 10.3), (130.0, 11.1)]


@pytest.mark.parametrize(("angle", "study"), LEVELS)
def test_error_levels_are_sharp_and_not_below_the_study(angle: float, study: float) -> None:
    whole = plan_of(angle)
    # The study asks for the hops; the stop at the hold point is no hop.
    question = Question(Plan(N, whole.start, whole.burns[:-1]), 50.0, 2.0 * ORBIT, STUDY)
    level = greatest_scale(question)
    assert 0.99 * study <= level <= 1.045 * study
    beyond = prove(Question(question.plan, 50.0, 2.0 * ORBIT, STUDY.scaled(1.01 * level)))
    assert min(finding.nearest for finding in beyond.findings) < 50.0


def test_random_plans() -> None:
    rng = np.random.default_rng(3)
    seen = set()
    for _ in range(60):
        burns, now = [], 0.0
        for _ in range(int(rng.integers(1, 5))):
            burns.append(Burn(now, tuple(rng.normal(0.0, 0.1, 3).tolist())))
            now += float(rng.uniform(100.0, 4000.0))
        at = rng.standard_normal(3)
        at *= rng.uniform(100.0, 500.0) / np.linalg.norm(at)
        plan = Plan(N, (*at.tolist(), *rng.normal(0.0, 0.05, 3).tolist()), tuple(burns))
        question = Question(plan, 30.0, float(rng.uniform(0.3, 2.0)) * ORBIT, STUDY, EVERYTHING)
        proof = prove(question, sharp=False)
        seen.add(proof.verdict)
        if proof.verdict is Verdict.VIOLATED:
            assert proof.counter_example is not None
            assert proof.counter_example.distance() < 30.0
        if proof.verdict is Verdict.PROVED:
            times = np.linspace(0.0, 0.99 * (question.horizon - 60.0), 400)
            for finding in proof.findings[:: max(1, len(proof.findings) // 8)]:
                state, _ = drawn(question, finding.case.kind, finding.case.burn, rng)
                assert distances(N, state, times).min() >= 30.0
    assert seen >= {Verdict.PROVED, Verdict.VIOLATED}


def test_bad_plans_are_named() -> None:
    good = plan_of(0.0)
    with pytest.raises(InvalidInput, match="burns: required 1 to"):
        Plan(N, good.start, ())
    with pytest.raises(InvalidInput, match="later than the burn before"):
        Plan(N, good.start, (good.burns[1], good.burns[0]))
    with pytest.raises(InvalidInput, match="not zero"):
        Plan(N, good.start, (Burn(0.0, (0.0, 0.0, 0.0)),))
    with pytest.raises(InvalidInput, match="stuck"):
        Question(good, 50.0, ORBIT, STUDY, Failures(stuck=10.0))
    with pytest.raises(InvalidInput, match="late_s"):
        Question(good, 50.0, ORBIT, STUDY, Failures(late=5000.0))
    with pytest.raises(InvalidInput, match="keep_out_m"):
        Question(good, 0.0, ORBIT)

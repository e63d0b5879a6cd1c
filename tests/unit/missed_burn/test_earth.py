"""The proof about the true Earth: flights with J2 on elliptic orbits within bounds, its documents, its mutations."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from flint import arb, fmpq

from safestart.dynamics.two_body_kernel import STAGES, WEIGHTS, drifted, placed, pushed, seen
from safestart.errors import InvalidInput
from safestart.missed_burn.cases import cases_of
from safestart.missed_burn.document import document_of
from safestart.missed_burn.earth.bound import strays_along
from safestart.missed_burn.earth.motion import Earth, drift_after, moved, target_before
from safestart.missed_burn.plan import Errors, Failures, Plan, Question
from safestart.missed_burn.prove import Verdict, greatest_scale, prove
from safestart.missed_burn.question_document import question_document
from safestart.proofs.abort.earth import sets as checked
from safestart.proofs.abort.earth.course import Course
from safestart.proofs.checker import check
from safestart.proofs.statement import digest_of
from safestart.proofs.strict import ProofRejected
from safestart.runtime.precision import precise
from tests.unit.missed_burn.flights import EVERYTHING, ORBIT, STUDY, N, plan_of, turned

A = 8.1e6
SHORT = Failures(30.0, True, 4.0, 0.002, math.radians(5.0))


def _asked(
    angle: float, e: float, errors: Errors = STUDY, failures: Failures = EVERYTHING, **more
) -> Question:
    plan = plan_of(angle)
    # Burns planned anew: before each the chaser is where the plan for a circle has it.
    earth = Earth.of(plan, A, e, 1.0, 0.4, 0.3, before=plan.before())
    return Question(
        plan, more.pop("keep_out", 50.0), more.pop("horizon", 2.0 * ORBIT), errors, failures, earth=earth
    )


def _flown(question: Question, kind: str, burn: int, rng):
    """A random flight in the true motion within the limits, after its event: the flight and how long it has drifted."""
    errors, failures, plan = question.errors, question.failures, question.plan
    k = max(burn, 0)
    box = np.array([*errors.position, *errors.velocity])
    state = question.before()[k] + box * rng.choice([-1.0, 1.0], 6)
    flight = placed(target_before(question, k), state)
    if kind == "start":
        return flight, 0.0
    share = 1.0 + errors.thrust_share * rng.choice([-1.0, 1.0])
    share *= rng.choice([0.0, 1.0, rng.random()]) if kind == "partial" else 1.0
    impulse = turned(share * np.array(plan.burns[k].impulse), errors.thrust_angle, rng, 0.7)
    wait = 0.0
    if kind == "misdirected":
        impulse = turned(impulse, failures.misdirected, rng, 0.7)
    if kind == "late":
        wait = failures.late * rng.choice([1.0, rng.random()])
        flight, _ = drifted(flight, wait, STAGES, WEIGHTS)
    pushed(flight, impulse)
    if kind == "stuck":
        wait = failures.stuck * rng.choice([1.0, rng.random()])
        push = failures.acceleration / np.linalg.norm(plan.burns[k].impulse) * impulse
        for _ in range(20):
            flight, _ = drifted(flight, wait / 40, STAGES, WEIGHTS)
            pushed(flight, wait / 20 * push)
            flight, _ = drifted(flight, wait / 40, STAGES, WEIGHTS)
    return flight, wait


@pytest.mark.parametrize(("angle", "e"), [(0.0, 0.0), (40.0, 0.1), (120.0, 0.01)])
def test_no_flight_with_j2_comes_nearer_than_its_case_allows(angle: float, e: float) -> None:
    question = _asked(angle, e)
    proof = prove(question)
    least: dict[tuple[str, int], float] = {}
    for finding in proof.findings:
        key = finding.case.kind, finding.case.burn
        least[key] = min(least.get(key, math.inf), finding.least)
    rng, close = np.random.default_rng(5), math.inf
    for (kind, burn), kept in least.items():
        for _ in range(12):
            flight, _ = _flown(question, kind, burn, rng)
            nearest = drifted(flight, question.horizon, STAGES, WEIGHTS)[1]
            # Between steps the flight's own distance is a cubic's.
            assert nearest >= kept - 0.05, (kind, burn)
            if kind == "made":
                close = min(close, nearest - kept)
    assert close < 10.0


def test_flights_stay_within_their_strays() -> None:
    question = _asked(90.0, 0.05, STUDY.scaled(20.0), Failures())
    rng = np.random.default_rng(2)
    for case in cases_of(question)[::2]:
        drift = drift_after(question, case.burn, case.share)
        strays, _ = strays_along(case, question, drift)
        for _ in range(4):
            flight, _ = _flown(question, case.kind, case.burn, rng)
            off, most = flight[6:] - drift.reference, 0.0
            for j in range(0, 90, 9):
                flight, _ = drifted(flight, drift.part * 9, STAGES, WEIGHTS)
                linear = drift.path[16 * (j + 9)] + drift.tables[16 * (j + 9), :3] @ off
                away = float(np.linalg.norm(flight[6:9] - linear))
                assert away <= strays[j + 8] + 1e-4
                most = max(most, away / (strays[j + 8] + 1e-4))
            # Not out of proportion: the bound takes all pushes as the worst ones.
            assert most > 1e-3


def test_the_v_bar_keeps_its_distance_about_the_true_earth() -> None:
    question = _asked(0.0, 0.0, failures=Failures())
    linear = greatest_scale(Question(question.plan, 50.0, 2.0 * ORBIT, STUDY))
    assert 0.8 * linear < greatest_scale(question) < 1.1 * linear


def test_counter_examples_are_flown_about_the_true_earth() -> None:
    proof = prove(_asked(0.0, 0.05, failures=Failures()))
    assert proof.verdict is Verdict.VIOLATED
    flown = proof.counter_example
    assert flown is not None
    assert flown.target is not None
    flight = placed(flown.target, flown.start)
    if len(flown.impulses):
        pushed(flight, flown.impulses[0])
    flight, _ = drifted(flight, flown.look - flown.begin, STAGES, WEIGHTS)
    assert np.linalg.norm(seen(flight)[:3]) == pytest.approx(flown.distance(), abs=1e-3)
    assert flown.distance() < 50.0


@pytest.fixture(scope="module")
def kept():
    """A document of one burn with every failure, at the perigee of an orbit of eccentricity 0.1."""
    plan = plan_of(40.0, 1, 1200.0)
    plan = Plan(N, plan.start, plan.burns[:1])
    earth = Earth.of(plan, A, 0.1, 1.0, 0.4, 0.0)
    proof = prove(Question(plan, 900.0, 0.25 * ORBIT, STUDY, SHORT, earth=earth))
    assert proof.verdict is Verdict.PROVED
    return json.dumps(document_of(proof)), proof.least


def _sealed(document):
    document["digest"] = digest_of({k: v for k, v in document.items() if k != "digest"})
    return document


def test_a_document_is_checked_along_an_enclosed_course(kept) -> None:
    text, least = kept
    verified = check(json.loads(text))
    assert verified.verdict == "PROVED"
    assert verified.margin_m == least
    assert "J2" in verified.statement[1]


def _raise(document):
    document["least_distance_m"] += 1.0


def _wider(document):
    document["question"]["errors"]["position_m"][1] *= 2.0


def _moved(document):
    document["question"]["before"][0]["position_m"][1] *= 0.99


def _flatter(document):
    document["question"]["target"]["velocity_m_s"][1] *= 0.9


def _narrow(document):
    document["cases"][0]["radii_m"] = [r * 0.99 for r in document["cases"][0]["radii_m"]]


def _hole(document):
    cells = document["cases"][1]["cells"]
    cells.remove(sorted(cells)[len(cells) // 2])


def _longer(document):
    document["question"]["target"]["position_m"].append(0.0)


@pytest.mark.parametrize("bent", [_raise, _wider, _moved, _flatter, _narrow, _hole, _longer])
def test_what_is_bent_is_refused(kept, bent) -> None:
    document = json.loads(kept[0])
    bent(document)
    with pytest.raises(ProofRejected):
        check(_sealed(document))


def test_the_remainder_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """With errors of 500 m a radius that is short by half of what the remainder does holds only without it."""
    plan = plan_of(40.0, 1, 1200.0)
    plan = Plan(N, plan.start, plan.burns[:1])
    earth = Earth.of(plan, A, 0.1, 1.0, 0.4, 0.0)
    question = Question(plan, 100.0, 0.25 * ORBIT, Errors((500.0, 0.0, 0.0)), earth=earth)
    proof = prove(question)
    document = json.loads(json.dumps(document_of(proof)))
    case = proof.findings[0].case
    strays, trials = strays_along(case, question, drift_after(question, case.burn, case.share))
    document["cases"][0]["radii_m"][-1] = float(trials[-1] - 0.5 * strays[-1])
    with pytest.raises(ProofRejected, match="radii_m"):
        check(_sealed(document))
    monkeypatch.setattr(checked.EarthChecker, "_remainder", lambda *_: arb(0))
    assert check(document).verdict == "PROVED"


def test_the_enclosed_course_is_the_flown_one() -> None:
    plan = plan_of(0.0)
    target = Earth.of(plan, A, 0.2, 1.0, 0.4, 0.0).target
    with precise(128):
        exact = [arb(fmpq(*e.as_integer_ratio())) for e in target]
        mu, j2, radius = (fmpq(*x.as_integer_ratio()) for x in (3.986004418e14, 1.08262668e-3, 6378137.0))
        course = Course(mu, j2, radius, exact, fmpq(4000))
        assert course.off < 1e-9
        at, _ = course.state(arb(3600))
        phi = course.motion(arb(3600))
        state, tables = moved(np.array(target), 3600.0)
        assert np.allclose([float(e) for e in at.entries()], state[:3], atol=1e-5)
        assert np.allclose([[float(e) for e in row] for row in phi.tolist()], tables, rtol=1e-8, atol=1e-9)


def test_refusals() -> None:
    plan = plan_of(0.0)
    with pytest.raises(InvalidInput, match="perigee above"):
        Earth.of(plan, A, 0.3)
    with pytest.raises(InvalidInput, match="states"):
        Earth.of(plan, A, before=plan.before()[:2])
    errors = Errors((0.1,) * 3, (1e-4,) * 3, at_each_burn=False)
    with pytest.raises(InvalidInput, match="at_each_burn"):
        Question(plan, 50.0, ORBIT, errors, earth=Earth.of(plan, A))


def test_the_start_of_a_document_is_the_state_before_the_first_burn() -> None:
    """The statement prints the states before the burns; another start would be believed though nothing reads it."""
    asked = _asked(40.0, 0.01, horizon=200.0, failures=Failures())
    states = asked.plan.before()
    states[0, 1] += 3.0
    given = Earth.of(asked.plan, A, 0.01, 1.0, 0.4, 0.3, before=states)
    # States that are given count, whatever the plan begins with.
    assert question_document(replace(asked, earth=given))["start"]["position_m"] == states[0, :3].tolist()
    made = json.loads(json.dumps(document_of(prove(asked))))
    made["question"]["start"]["position_m"][0] += 1.0
    made["digest"] = digest_of({k: v for k, v in made.items() if k != "digest"})
    with pytest.raises(ProofRejected, match="before the first burn"):
        check(made)

"""Burns with a duration: no flight beats a bound, failures replay, documents are checked and bent ones refused."""

import json
import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from safestart.errors import InvalidInput
from safestart.missed_burn.cases import cases_of
from safestart.missed_burn.document import document_of
from safestart.missed_burn.plan import Burn, Errors, Failures, Plan, Question
from safestart.missed_burn.prove import Proof, Verdict, prove
from safestart.proofs.abort import finite
from safestart.proofs.checker import check
from safestart.proofs.statement import digest_of
from safestart.proofs.strict import ProofRejected
from tests.unit.missed_burn.flights import ORBIT, STUDY, N, plan_of, turned

THRUST = 0.2
KINDS = ("made", "cut", "partial", "late", "stuck", "misdirected")
FAILURES = Failures(60.0, True, 0.1, 0.0, math.radians(5.0))


def lasting(plan: Plan, thrust: float = THRUST) -> Plan:
    """The same impulses, each at a thrust, around the time of the impulse."""
    first = 0.5 * plan.burns[0].size / thrust
    burns = [Burn(b.time + first - 0.5 * b.size / thrust, b.impulse, b.size / thrust) for b in plan.burns]
    return Plan(N, plan.start, tuple(burns))


@pytest.fixture(scope="module")
def proof() -> Proof:
    return prove(Question(lasting(plan_of(40.0, 3)), 50.0, ORBIT, STUDY, FAILURES), sharp=False)


def _path(state, begin, on, pushes, until):
    """Distances in CWH motion, integrated: thrust from ``begin`` on for ``on`` s, in as many parts as pushes."""

    def rates(t, s):
        x, _, z, u, v, w = s
        part = min(int((t - begin) / on * len(pushes)), len(pushes) - 1) if begin <= t < begin + on else -1
        a = pushes[part] if part >= 0 else np.zeros(3)
        return [u, v, w, 3 * N * N * x + 2 * N * v + a[0], -2 * N * u + a[1], -N * N * z + a[2]]

    cuts = [0.0, begin, *(begin + on * (k + 1) / len(pushes) for k in range(len(pushes))), until]
    found = []
    for one, two in pairwise(cuts):
        if two <= one:
            continue
        times = np.linspace(one, two, 200)
        done = solve_ivp(
            rates, (one, two), state, t_eval=times, rtol=1e-9, atol=1e-9, max_step=(two - one) / 4
        )
        found.append(np.linalg.norm(done.y[:3], axis=0))
        state = done.y[:, -1]
    return np.concatenate(found)


def test_no_flight_comes_nearer_whatever_fails_and_also_while_it_burns(proof: Proof) -> None:
    question, rng = proof.question, np.random.default_rng(5)
    assert proof.verdict is Verdict.PROVED
    errors, failures, before = question.errors, question.failures, question.before()
    box = np.array([*errors.position, *errors.velocity])
    close = math.inf
    for number in range(60):
        k, kind = int(rng.integers(len(question.plan.burns))), KINDS[number % len(KINDS)]
        burn = question.plan.burns[k]
        on, begin, share, angle = burn.duration, 0.0, 1.0, 0.0
        if kind == "cut":
            on *= rng.random()
        if kind == "partial":
            share = rng.random()
        if kind == "late":
            begin = failures.late * rng.random()
        if kind == "stuck":
            on += failures.stuck * rng.random()
        base = np.array(burn.impulse) / burn.duration
        if kind == "misdirected":
            angle = failures.misdirected
        base = share * turned(base, angle, rng, 1.0)
        # Size and direction are off by their errors, differently in each third of the burn.
        pushes = [
            turned((1.0 + errors.thrust_share * rng.choice([-1, 1])) * base, errors.thrust_angle, rng, 1.0)
            for _ in range(3)
        ]
        until = question.horizon + begin + on
        distances = _path(before[k] + box * rng.choice([-1.0, 1.0], 6), begin, max(on, 1e-6), pushes, until)
        close = min(close, distances.min())
        assert distances.min() >= proof.least
    assert close < proof.least + 60.0


def test_a_lasting_burn_that_is_short_is_an_impulse() -> None:
    """One that ends early is one that is burnt in part."""
    plan = plan_of(40.0, 3)
    at_once = prove(Question(plan, 50.0, ORBIT, STUDY, Failures(partial=True)))
    short = prove(Question(lasting(plan, 1e4), 50.0, ORBIT, STUDY))
    assert short.least == pytest.approx(at_once.least, abs=0.2)


def test_failures_that_come_near_are_replayed_within_their_limits() -> None:
    plan = Plan(N, (0.0, 150.0, 0.0, 0.0, 0.0, 0.0), (Burn(0.0, (-0.054, 0.0, 0.0), 40.0),))
    for radius in (None, 8.1e6):
        found = prove(Question(plan, 50.0, ORBIT, STUDY, FAILURES, radius), sharp=False)
        assert found.verdict is Verdict.VIOLATED
        flown = found.counter_example
        assert flown is not None
        assert flown.distance(radius) < 50.0
        assert len(flown.durations) <= 1
        assert flown.durations.max(initial=0.0) <= 40.0 + FAILURES.stuck + 1e-9


def test_each_failure_has_its_cases() -> None:
    question = Question(lasting(plan_of(0.0, 2)), 50.0, ORBIT, STUDY, FAILURES)
    kinds = {case.kind for case in cases_of(question)}
    assert kinds == {"start", "made", "cut", "partial", "misdirected", "late", "stuck"}
    assert {case.kind for case in cases_of(Question(question.plan, 50.0, ORBIT))} == {"start", "made", "cut"}


@pytest.fixture
def document(proof: Proof):
    return json.loads(json.dumps(document_of(proof)))


def _sealed(document):
    document["digest"] = digest_of({k: v for k, v in document.items() if k != "digest"})
    return document


def test_the_document_is_checked_by_its_own_arithmetic(document, proof: Proof) -> None:
    verified = check(document)
    assert verified.verdict == "PROVED"
    assert verified.margin_m == proof.least
    assert any("ended early, at any time" in line for line in verified.statement)


def test_the_nonlinear_motion_is_checked_too_and_its_radii_count() -> None:
    plan = Plan(N, (0.0, 300.0, 0.0, 0.0, 0.0, 0.0), (Burn(0.0, (0.05, 0.0, 0.0), 40.0),))
    made = prove(Question(plan, 50.0, 0.3 * ORBIT, STUDY, Failures(20.0), 8.1e6), sharp=False)
    document = json.loads(json.dumps(document_of(made)))
    assert check(document).verdict == "PROVED"
    cut = next(case for case in document["cases"] if case["kind"] == "cut")
    cut["radii_m"] = [radius - 1.0 for radius in cut["radii_m"]]
    with pytest.raises(ProofRejected, match="radii_m"):
        check(_sealed(document))


def _late_piece(document):
    """The path of a late burn in one of its thirds of time is left out."""
    found = [c for c in document["cases"] if c["kind"] == "late" and c["burn"] == 1]
    document["cases"].remove(
        next(c for c in found if c["on_first_s"] > 0.0 and c["on_first_s"] < c["on_last_s"])
    )


def _whole(document):
    whole = document["question"]["burns"][1]["duration_s"]
    document["cases"] = [
        c
        for c in document["cases"]
        if not (c["kind"] == "late" and c["burn"] == 1 and c["on_first_s"] == whole)
    ]


def _no_cut(document):
    document["cases"] = [c for c in document["cases"] if c["kind"] != "cut"]


def _longer(document):
    document["question"]["burns"][-1]["duration_s"] *= 1.01


def _stronger(document):
    document["question"]["burns"][2]["impulse_m_s"][0] *= 1.2


@pytest.mark.parametrize("bent", [_late_piece, _whole, _no_cut, _longer, _stronger])
def test_what_is_bent_is_refused(document, bent) -> None:
    bent(document)
    with pytest.raises(ProofRejected):
        check(_sealed(document))


def test_the_bend_of_the_pieces_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """A document whose errors vary while it burns is refused where the prover takes them as steady."""
    errors = Errors((0.0,) * 3, (0.0,) * 3, 0.2, 0.2)
    plan = Plan(N, (0.0, 300.0, 0.0, 0.0, 0.0, 0.0), (Burn(0.0, (0.0, 0.05, 0.0), 300.0),))
    monkeypatch.setattr("safestart.missed_burn.sets.StateSet.box", lambda *_: None)
    document = document_of(prove(Question(plan, 50.0, 0.4 * ORBIT, errors)))
    monkeypatch.undo()
    with pytest.raises(ProofRejected, match="short by"):
        check(document)
    monkeypatch.setattr(finite, "_rates", lambda *_: finite.Rates(*([finite.arb(0)] * 6 for _ in range(2))))
    assert check(document).verdict == "PROVED"


def test_bad_burns_are_named() -> None:
    good = plan_of(0.0, 2)
    one, two, three = good.burns
    with pytest.raises(InvalidInput, match="an end before the next burn"):
        Plan(N, good.start, (Burn(one.time, one.impulse, two.time + 1.0), two, three))
    long = Plan(N, good.start, (Burn(0.0, one.impulse, 0.4 / N),))
    with pytest.raises(InvalidInput, match=r"burns\.0\.duration_s"):
        Question(long, 50.0, ORBIT, STUDY, Failures(0.2 / N))
    with pytest.raises(InvalidInput, match="acceleration"):
        Question(good, 50.0, ORBIT, STUDY, Failures(stuck=10.0))

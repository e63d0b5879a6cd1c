"""The nonlinear model: flights about a point mass stay within strays and bounds, its documents, its mutation."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from safestart.dynamics.cwh import transition_matrix
from safestart.errors import InvalidInput
from safestart.missed_burn.cases import cases_of
from safestart.missed_burn.document import document_of
from safestart.missed_burn.plan import Errors, Plan, Question
from safestart.missed_burn.prove import Verdict, greatest_scale, prove
from safestart.missed_burn.strays import PARTS, strays_of
from safestart.proofs.abort import strays as checked
from safestart.proofs.checker import check
from safestart.proofs.statement import digest_of
from safestart.proofs.strict import ProofRejected
from tests.unit.missed_burn.flights import EVERYTHING, ORBIT, STUDY, N, drawn, plan_of

R = 8.1e6


def _flown(state, times):
    """Positions (T, 3) by Cowell's way: both bodies about the Earth, in an inertial frame."""
    mu = N * N * R**3

    def rates(_, y):
        r = np.linalg.norm(y[:3])
        return np.concatenate([y[3:], -mu / r**3 * y[:3]])

    inertial = np.r_[
        R + state[0], state[1:3], state[3] - N * state[1], state[4] + N * (R + state[0]), state[5]
    ]
    y = solve_ivp(rates, (0.0, times[-1]), inertial, method="DOP853", t_eval=times, rtol=1e-12, atol=1e-7).y.T
    c, s = np.cos(N * times), np.sin(N * times)
    return np.stack([c * y[:, 0] + s * y[:, 1] - R, -s * y[:, 0] + c * y[:, 1], y[:, 2]], axis=1)


def test_flights_stay_within_their_strays_and_bounds() -> None:
    question = Question(plan_of(0.0), 20.0, 2.0 * ORBIT, STUDY.scaled(0.5), EVERYTHING, R)
    rng = np.random.default_rng(2)
    for case in cases_of(question)[::5]:
        if case.kind in ("late", "stuck"):
            continue
        strays, _ = strays_of(case, question, R)
        times = case.duration / PARTS * np.arange(1, PARTS + 1)
        for _ in range(3):
            state, _ = drawn(question, case.kind, case.burn, rng)
            linear = np.array([(transition_matrix(N, t) @ state)[:3] for t in times])
            away = np.abs(_flown(state, times) - linear)
            assert (away <= strays + 1e-4).all()
    # Not out of proportion either, where it counts: at the end of the last hops.
    assert strays[-1, 1] < 100.0


def test_the_v_bar_keeps_its_distance_in_the_nonlinear_motion() -> None:
    question = Question(plan_of(0.0), 50.0, 2.0 * ORBIT, STUDY.scaled(0.3), radius=R)
    proof = prove(question)
    assert proof.verdict is Verdict.PROVED
    verified = check(document_of(proof))
    assert "nonlinear" in verified.statement[1]
    linear = greatest_scale(Question(question.plan, 50.0, 2.0 * ORBIT, STUDY))
    assert 0.9 * linear < greatest_scale(Question(question.plan, 50.0, 2.0 * ORBIT, STUDY, radius=R)) < linear


def test_counter_examples_are_flown_in_the_nonlinear_motion() -> None:
    proof = prove(Question(plan_of(0.0), 50.0, 2.0 * ORBIT, STUDY, radius=R))
    assert proof.verdict is Verdict.VIOLATED
    flown = proof.counter_example
    assert flown is not None
    state = flown.start + np.r_[0.0, 0.0, 0.0, flown.impulses[0]]
    there = _flown(state, np.array([0.0, flown.look - flown.times[0]]))[-1]
    assert np.linalg.norm(there) < 50.0
    assert np.linalg.norm(there) == pytest.approx(flown.distance(R), abs=1e-3)


def test_the_nonlinear_remainder_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """A linear proof, relabelled: its radii hold only if the remainder is dropped."""
    whole = plan_of(0.0)
    question = Question(Plan(N, whole.start, whole.burns[:1]), 900.0, 2.0 * ORBIT, Errors(), radius=R)
    proof = prove(question)
    assert proof.verdict is Verdict.UNKNOWN or proof.least < 1098.0
    linear = prove(Question(question.plan, 900.0, 2.0 * ORBIT, Errors()))
    document = document_of(linear)
    document["question"]["model"] = "nonlinear"
    document["question"]["semi_major_axis_m"] = R
    for case in document["cases"]:
        case["radii_m"] = [2100.0] * PARTS
    document["digest"] = digest_of({k: v for k, v in document.items() if k != "digest"})
    with pytest.raises(ProofRejected):
        check(document)
    monkeypatch.setattr(checked, "remainder", lambda n, r, rho: 0 * rho)
    assert check(document).verdict == "PROVED"


def test_errors_that_add_up_are_refused() -> None:
    errors = Errors((0.1,) * 3, (1e-4,) * 3, at_each_burn=False)
    with pytest.raises(InvalidInput, match="at_each_burn"):
        Question(plan_of(0.0), 50.0, ORBIT, errors, radius=R)

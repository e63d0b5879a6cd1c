"""The exact answer against the paper's certificate and against an independent linear program."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.exact_answers import certified, disagreements, one_sided, run
from benchmarks.peers.dense_lp import DenseLP
from safestart.closed_form.paper import certify
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.exact.prove import proof_of
from safestart.exact.question import Goal, Question
from safestart.model.scenario import Scenario
from safestart.proofs.single import check

COUNTEREXAMPLE = np.array([9.364, 81.044, 0.0, 0.0])


@pytest.mark.parametrize(("dt", "steps"), [(2.0, 30), (1.0, 60)])
def test_the_certified_start_that_cannot_stay_has_a_proof(dt: float, steps: int) -> None:
    """At all times and with the whole disk: -1.194 m; the relaxed program of test_certificate_limits says -1.148 m."""
    scenario = Scenario.of(2.0, 0.05)
    assert bool(certify(scenario, COUNTEREXAMPLE[:2]).safe)
    question = Question(scenario, dt, steps)
    answer = decide(question, COUNTEREXAMPLE)
    assert answer.verdict is Verdict.NO_GO
    assert answer.margin_m == pytest.approx(-1.1941, abs=3e-4)
    assert check(json.loads(json.dumps(proof_of(question, COUNTEREXAMPLE, answer)))).verdict == "NO_GO"
    inner = DenseLP(scenario, dt, steps).margin(COUNTEREXAMPLE)
    assert inner - 0.01 < answer.upper < -1.148


@pytest.mark.slow
def test_sixty_starts_of_the_sweep() -> None:
    """A short version of the study in benchmarks/exact_answers.py."""
    cases = run(60, 7)
    verdicts = {verdict: sum(case.answer.verdict is verdict for case in cases) for verdict in Verdict}
    assert min(verdicts[Verdict.GO], verdicts[Verdict.NO_GO]) >= 15
    assert verdicts[Verdict.UNDECIDED] == 0
    assert not any(math.isnan(case.verify_s) for case in cases)
    assert disagreements(cases) == []
    assert all(case.inner < 0.0 < case.outer for case in one_sided(cases))
    assert not any(certified(case) and case.answer.verdict is Verdict.NO_GO for case in cases)


def test_a_certified_start_that_stays_but_does_not_synchronize_in_time() -> None:
    """Next to the synchronization range 200 s are not enough; of 126 other certified starts all are at rest by then."""
    state = np.array([19.25632377, 148.7588451, 0.0, 0.0])
    staying = Question(Scenario.of(2.0, 0.1), steps=100)
    assert bool(certify(staying.scenario, state[:2]).safe)
    assert decide(staying, state, verdict_only=True).verdict is Verdict.GO
    question = replace(staying, goal=Goal(hold=(0.0, 2.0)))
    answer = decide(question, state)
    assert answer.verdict is Verdict.NO_GO
    assert check(proof_of(question, state, answer)).verdict == "NO_GO"
    longer = replace(question, steps=150)
    found = decide(longer, state, verdict_only=True)
    assert found.verdict is Verdict.GO

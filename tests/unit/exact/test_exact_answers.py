"""Exact answers: brackets, witnesses flown by another integrator, the linear program as an independent solver."""

import json
import math
import subprocess
import sys

import numpy as np
import pytest

from benchmarks.peers.dense_lp import DenseLP
from benchmarks.peers.flown import fly
from safestart.errors import InvalidInput
from safestart.exact import search
from safestart.exact.answer import Answer, Verdict
from safestart.exact.decide import decide
from safestart.exact.kernels import stay
from safestart.exact.prove import proof_of
from safestart.exact.question import Question
from safestart.exact.watch import watch_of
from safestart.model.scenario import Chaser, CorridorShape, Floats, Scenario, Target
from safestart.optim.largest_margin import Solved
from safestart.proofs.checker import check
from tests.unit.exact.linear_model import rows

SWEEP = [(0.02, 1.0, 30.0), (0.05, 2.0, 50.0), (0.10, 3.0, 50.0), (0.10, 2.0, 100.0), (0.05, 5.0, 30.0)]


def start(radius: float, angle: float, dimensions: int = 2, speed: float = 0.0) -> Floats:
    state = np.zeros(2 * dimensions)
    state[:2] = radius * math.sin(angle), radius * math.cos(angle)
    if dimensions == 3:
        state[2] = 0.2 * radius
    if speed:
        state[dimensions:] = speed * np.array([0.6, -0.7, 0.4])[:dimensions]
    return state


def answers(dimensions: int, speed: float) -> list[tuple[Question, Floats, Answer]]:
    out = []
    for a_max, rate, radius in SWEEP:
        question = Question(Scenario.of(rate, a_max), dimensions=dimensions)
        for angle in (-0.6, 0.0, 0.5):
            state = start(radius, angle, dimensions, speed)
            out.append((question, state, decide(question, state)))
    return out


@pytest.mark.parametrize(("dimensions", "speed"), [(2, 0.0), (2, 1.0), (3, 0.0), (3, 0.8)])
def test_witnesses_fly_and_multipliers_bound(dimensions: int, speed: float) -> None:
    seen = set()
    for question, state, answer in answers(dimensions, speed):
        seen.add(answer.verdict)
        assert answer.lower <= answer.upper
        assert answer.gap <= 1e-4
        a_max = question.scenario.chaser.max_acceleration
        if answer.verdict is Verdict.GO:
            assert answer.thrust is not None
            assert not answer.multipliers
            assert answer.margin_m == answer.lower > 0.0
            assert np.sqrt((answer.thrust**2).sum(axis=1)).max() <= a_max
            assert fly(question, state, answer.thrust) == pytest.approx(answer.margin_m, abs=1e-6)
        else:
            assert answer.verdict is Verdict.NO_GO
            assert answer.thrust is None
            assert answer.margin_m == answer.upper < 0.0
            # The bound again, from the plain model and not from the search's tables.
            times = np.array([m.time for m in answer.multipliers])
            weights = np.array([m.value for m in answer.multipliers])
            faces = [watch_of(question).names.index(m.face) for m in answer.multipliers]
            model = rows(question, times)
            each = np.arange(len(times))
            pull = (weights @ model.thrust[each, faces]).reshape(-1, dimensions)
            bound = weights @ model.constant(state)[each, faces] + a_max * np.linalg.norm(pull, axis=1).sum()
            assert (weights >= 0.0).all()
            assert weights.sum() == pytest.approx(1.0, abs=1e-12)
            assert bound == pytest.approx(answer.upper, abs=1e-9)
    assert seen == {Verdict.GO, Verdict.NO_GO}


def test_the_margin_agrees_with_the_linear_program() -> None:
    """The polygons inside and around the disk bracket the margin; the program's samples can only add to it."""
    for a_max, rate, radius in SWEEP[:4]:
        scenario = Scenario.of(rate, a_max)
        inner, outer = DenseLP(scenario), DenseLP(scenario, outer=True)
        for angle in (-0.4, 0.3):
            state = start(radius, angle)
            answer = decide(Question(scenario), state)
            # Between samples 0.5 s apart a distance dips by at most |f''| / 32, some centimetres here.
            assert inner.margin(state) - 0.05 <= answer.upper
            assert answer.lower <= outer.margin(state) + 1e-6


def test_a_flight_stays_above_its_bound_between_the_samples() -> None:
    rng = np.random.default_rng(3)
    for dimensions in (2, 3):
        question = Question(Scenario.of(5.0, 0.1), dimensions=dimensions)
        state = start(80.0, 0.2, dimensions, 1.0)
        thrust = 0.05 * rng.normal(size=(30, dimensions))
        minima = watch_of(question).minima(state, thrust)
        exact = fly(question, state, thrust)
        assert exact - 1e-6 < minima.lowest <= exact + 1e-9
        at = int(np.argmin(minima.values))
        model = rows(question, minima.times[at : at + 1])
        distance = (model.constant(state) + model.thrust @ thrust.ravel())[0, minima.faces[at]]
        assert distance == pytest.approx(minima.values[at], abs=1e-6)


@pytest.mark.parametrize("mean_motion", [0.0, 1.1e-3, 1.3e-3])
@pytest.mark.parametrize("dt", [2.0, 300.0, 900.0])
def test_cuts_are_the_rows_of_the_plain_model(mean_motion: float, dt: float) -> None:
    for dimensions in (2, 3):
        question = Question(Scenario.of(2.0, 0.1, mean_motion), dt, 4, dimensions)
        times = np.array([0.0, 0.3 * dt, dt, 2.7 * dt, 4.0 * dt])
        faces = np.array([0, 1, 2, 1, 2 * dimensions - 2])
        cuts, model = watch_of(question).cuts(times, faces), rows(question, times)
        each = np.arange(5)
        np.testing.assert_allclose(cuts.thrust, model.thrust[each, faces], rtol=1e-9, atol=1e-8)
        np.testing.assert_allclose(cuts.start, model.start[each, faces], rtol=1e-9, atol=1e-9)


def test_outside_is_refused_at_once() -> None:
    question = Question(Scenario.of(1.0, 0.1))
    answer = decide(question, np.array([100.0, 10.0, 0.0, 0.0]))
    assert answer.verdict is Verdict.NO_GO
    assert answer.iterations == 0
    assert [(m.time, m.face, m.value) for m in answer.multipliers] == [(0.0, "right", 1.0)]
    assert answer.lower <= answer.upper == answer.margin_m < 0.0


def test_without_tumble_and_with_the_verdict_only() -> None:
    state = np.array([0.0, 40.0, 0.0, 0.0])
    still = Question(Scenario.of(0.0, 0.1))
    assert decide(still, state).verdict is Verdict.GO
    for question, other, answer in answers(2, 0.0):
        quick = decide(question, other, verdict_only=True)
        assert quick.verdict is answer.verdict
        assert quick.iterations <= answer.iterations
        assert quick.lower <= answer.upper
        assert answer.lower <= quick.upper


def test_a_start_on_the_edge_is_undecided() -> None:
    """On a face the margin is 0 at best, and neither a witness nor multipliers can say more."""
    answer = decide(Question(Scenario.of(0.0, 0.1)), np.array([0.0, 0.5, 0.0, 0.0]))
    assert answer.verdict is Verdict.UNDECIDED
    assert answer.lower <= 0.0 <= answer.upper + 1e-9
    assert answer.reason


def test_a_failing_solver_is_never_a_go(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stay, "narrow", lambda *_: (False, *[None] * 7))
    monkeypatch.setattr(search, "solve", lambda *_, **__: Solved("NumericalError"))
    answer = decide(Question(Scenario.of(1.0, 0.1)), np.array([0.0, 40.0, 0.0, 0.0]))
    assert answer.verdict is Verdict.UNDECIDED
    assert "NumericalError" in answer.reason
    assert answer.thrust is None


@pytest.mark.parametrize("state", [np.zeros(6), np.array([0.0, math.nan, 0.0, 0.0]), np.full(4, 1e9)])
def test_bad_states(state: Floats) -> None:
    with pytest.raises(InvalidInput):
        decide(Question(Scenario.of(1.0, 0.1)), state)


@pytest.mark.parametrize("module", ["safestart.closed_form.paper", "safestart.cli"])
def test_the_solver_is_loaded_with_the_first_question(module: str) -> None:
    code = f"import sys, {module}; assert not {{'clarabel', 'scipy', 'flint'}} & set(sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


# The best margins of these starts are some 1e-7 m: less than the samples of a flight can miss between them.
PLANE = CorridorShape(
    1.7203236335675727, 2.5615604699279904, 0.4118317879587087, 0.5390083732169668, 4.007733165604491
)
SPACE = CorridorShape(
    1.33290825511154, 0.7745810153290553, 1.4193906040434443, 1.0884285415470172, 4.074817666023508
)


@pytest.mark.parametrize(
    ("rate_deg_s", "a_max", "shape", "steps", "state", "best_m"),
    [
        (
            4.34121385508196,
            0.8860379068144187,
            PLANE,
            5,
            (5.794526062471715, 7.136617993012427, -0.5407306641603287, 0.4390424048649522),
            1.2e-7,
        ),
        (
            2.7426358020396373,
            0.9264420940026529,
            SPACE,
            30,
            (-65.28363368269486, 51.98827563152051, -10.22366476602657, 0.0, 0.0, 0.0),
            3.4e-7,
        ),
    ],
    ids=["plane", "space"],
)
def test_a_close_call_is_decided(
    rate_deg_s: float, a_max: float, shape: CorridorShape, steps: int, state: tuple[float, ...], best_m: float
) -> None:
    """It was UNDECIDED, between -6e-7 and 3e-7 m; the checker, which bounds flights in its own way, says GO as well."""
    scenario = Scenario(Target(math.radians(rate_deg_s), 1.1e-3), Chaser(a_max), shape)
    question = Question(scenario, 2.0, steps, len(state) // 2)
    answer = decide(question, np.array(state))
    assert answer.verdict is Verdict.GO
    assert answer.lower == pytest.approx(best_m, rel=0.1)
    found = check(json.loads(json.dumps(proof_of(question, np.array(state), answer))))
    assert found.verdict == "GO"
    assert 0.0 < found.margin_m <= answer.lower

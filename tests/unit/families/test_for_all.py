"""Verdicts for all members of a family: flown by another model, held against single answers, widened and narrowed."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from safestart.dynamics.cwh import Cwh
from safestart.errors import InvalidInput
from safestart.exact import search
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.exact.kernels import stay
from safestart.exact.question import Question
from safestart.families.answer import Witness
from safestart.families.between import chord_gap, half_angle, nodes, reach, turned
from safestart.families.decide import decide_for_all
from safestart.families.members import Family, corner_signs
from safestart.model.scenario import Floats, Scenario
from safestart.optim.largest_margin import Solved
from safestart.optim.prediction import prediction_of
from tests.unit.families.family_twin import distances, draw


def family(dimensions: int = 2, rate: float = 3.0, a_max: float = 0.1, width: float = 1.0) -> Family:
    """1 % of the tumble rate, 2 % of the thrust, 1 % of the mean motion, 0.5 m and 0.02 m/s, times ``width``."""
    question = Question(Scenario.of(rate, a_max), dimensions=dimensions)
    return Family(
        question,
        width * 0.01 * math.radians(rate),
        width * 0.02 * a_max,
        width * 1.1e-5,
        (width * 0.5,) * dimensions + (width * 0.02,) * dimensions,
    )


def start(x: float, y: float, dimensions: int = 2, z: float = 3.0) -> Floats:
    state = np.zeros(2 * dimensions)
    state[:2] = x, y
    if dimensions == 3:
        state[2] = z
    return state


@pytest.mark.parametrize(
    ("made", "state"),
    [
        (family(), start(12.0, 45.0)),
        (family(rate=5.0), start(0.0, 15.0)),
        (family(rate=1.0, a_max=0.05), start(-8.0, 30.0)),
        (family(3), start(12.0, 45.0, 3)),
        (family(3, rate=2.0), start(5.0, 25.0, 3, 24.0)),
    ],
)
def test_no_member_comes_closer_than_the_common_history_promises(made: Family, state: Floats) -> None:
    answer = decide_for_all(made, state)
    assert answer.verdict is Verdict.GO
    assert answer.margin_m <= answer.upper <= answer.margin_m + 2e-3
    thrust = answer.histories[0].thrust
    assert np.sqrt((thrust**2).sum(axis=1)).max() <= made.thrusts[0]
    kept = distances(made.question, *draw(made, state, 1000, 1), thrust)
    assert kept.min() >= answer.margin_m - 1e-9
    # And the promise is no smaller than it need be: a corner comes this close.
    corner = corner_signs(made.half) * made.half + state
    for rate in made.rates:
        at = np.full(len(corner), rate), np.full(len(corner), made.motions[0]), corner
        kept = np.append(kept, distances(made.question, *at, thrust))
    assert kept.min() <= answer.margin_m + 0.03


@pytest.mark.parametrize("dimensions", [2, 3])
def test_without_width_the_answer_is_that_of_one_start(dimensions: int) -> None:
    for rate, x, y in ((3.0, 12.0, 45.0), (2.0, 9.0, 90.0), (5.0, -20.0, 40.0), (1.0, 60.0, 50.0)):
        made, state = family(dimensions, rate, width=0.0), start(x, y, dimensions)
        one, every = decide(made.question, state), decide_for_all(made, state, tolerance=1e-4)
        assert every.verdict is one.verdict
        assert every.margin_m == pytest.approx(one.margin_m, abs=2e-4 if one.verdict is Verdict.GO else 0.6)
        assert every.margin_m >= one.lower - 1e-4
        assert decide_for_all(made, state, witness="per_corner").verdict is one.verdict


@pytest.mark.parametrize(
    ("made", "state"),
    [
        (family(), start(-30.0, 120.0)),
        (family(rate=5.0, a_max=0.02), start(3.0, 30.0)),
        (family(rate=2.0, a_max=0.05, width=2.0), start(20.0, 85.0)),
        (family(3, rate=4.0), start(10.0, 80.0, 3)),
    ],
)
def test_no_member_of_a_no_go_stays(made: Family, state: Floats) -> None:
    answer = decide_for_all(made, state)
    assert answer.verdict is Verdict.NO_GO
    assert [answer.pieces[0].rates[0], answer.pieces[-1].rates[1]] == list(made.rates)
    for rate, motion, member in zip(*draw(made, state, 40, 2), strict=True):
        single = decide(made.member(float(rate), float(motion), made.thrusts[1]), member)
        assert single.verdict is Verdict.NO_GO
        assert single.lower <= answer.margin_m


def test_wider_sets_never_keep_more() -> None:
    for rate, state in ((3.0, start(12.0, 45.0)), (2.0, start(3.0, 60.0))):
        answers = [decide_for_all(family(rate=rate, width=width), state) for width in (0.0, 0.3, 0.6, 1.0)]
        for narrow, wide in pairwise(answers):
            assert wide.margin_m <= narrow.upper
            assert wide.upper <= narrow.upper + 1e-9
    state = start(-30.0, 120.0)
    refused = [decide_for_all(family(width=width), state).margin_m for width in (0.0, 1.0, 2.0)]
    assert refused[0] < refused[1] < refused[2] < 0.0


def test_each_width_counts() -> None:
    """The margin that one uncertainty costs: the box exactly, the thrust as the single answer with less of it."""
    state, question = start(12.0, 45.0), Question(Scenario.of(3.0, 0.1))
    alone = decide(question, state).margin_m
    weaker = decide_for_all(Family(question, max_acceleration=0.01), state).margin_m
    assert weaker == pytest.approx(decide(Question(Scenario.of(3.0, 0.09)), state).margin_m, abs=1e-3)
    for made in (
        Family(question, tumble_rate=1e-3),
        Family(question, mean_motion=1e-4),
        Family(question, start=(1.0, 0.0, 0.0, 0.0)),
        Family(question, start=(0.0, 0.0, 0.0, 0.02)),
    ):
        answer = decide_for_all(made, state)
        assert answer.verdict is Verdict.GO
        assert answer.margin_m < alone - 0.005
        assert (
            distances(question, *draw(made, state, 400, 3), answer.histories[0].thrust).min()
            >= answer.margin_m
        )


def test_undecided_names_two_members_that_differ() -> None:
    made, seen = family(), set()
    for y in np.linspace(55.0, 71.0, 17):
        state = start(12.0, float(y))
        answer = decide_for_all(made, state)
        if answer.verdict is not Verdict.UNDECIDED:
            seen.add(answer.verdict)
            continue
        assert math.isnan(answer.margin_m)
        assert "depends" in answer.reason
        first, second = answer.examples
        assert {first.answer.verdict, second.answer.verdict} == {Verdict.GO, Verdict.NO_GO}
        seen.add(f"middle {first.answer.verdict}")
        for example in answer.examples:
            target, chaser = example.question.scenario.target, example.question.scenario.chaser
            assert made.rates[0] <= target.tumble_rate <= made.rates[1]
            assert made.motions[0] <= target.mean_motion <= made.motions[1]
            assert made.thrusts[0] <= chaser.max_acceleration <= made.thrusts[1]
            assert (np.abs(example.start - state) <= made.half + 1e-12).all()
            assert decide(example.question, example.start).verdict is example.answer.verdict
    assert seen == {Verdict.GO, Verdict.NO_GO, "middle GO", "middle NO_GO"}


@pytest.mark.parametrize("witness", ["common", "per_corner"])
def test_a_box_that_reaches_outside_is_undecided(witness: Witness) -> None:
    made = Family(Question(Scenario.of(1.0, 0.1)), start=(0.0, 0.5, 0.0, 0.0))
    answer = decide_for_all(made, start(0.0, 0.9), witness=witness)
    assert answer.verdict is Verdict.UNDECIDED
    assert answer.upper == pytest.approx(-0.1)
    assert [example.answer.verdict for example in answer.examples] == [Verdict.GO, Verdict.NO_GO]
    assert answer.examples[1].start[1] == pytest.approx(0.4)
    away = decide_for_all(made, start(0.0, -0.1), witness=witness)
    assert away.verdict is Verdict.NO_GO
    assert away.margin_m == pytest.approx(-0.1, abs=0.01)


@pytest.mark.parametrize("dimensions", [2, 3])
def test_mixtures_of_the_corners_histories_stay(dimensions: int) -> None:
    made = family(dimensions, rate=2.0)
    made = replace(made, start=(0.5, 0.0, 0.0, 0.02) if dimensions == 2 else (0.5, 0.3, 0.0, 0.02, 0.0, 0.0))
    state = start(10.0, 60.0, dimensions)
    common, answer = decide_for_all(made, state), decide_for_all(made, state, witness="per_corner")
    assert answer.verdict is Verdict.GO
    assert len(answer.histories) == 2 ** int((made.half > 0).sum())
    assert answer.upper >= common.margin_m - 1e-9
    rng, corners = np.random.default_rng(5), np.array([history.corner for history in answer.histories])
    share = rng.dirichlet(np.full(len(corners), 0.3), 500)
    rates, motions, _ = draw(made, state, 500, 6)
    thrust = np.einsum("mc,cnd->mnd", share, np.array([history.thrust for history in answer.histories]))
    kept = distances(made.question, rates, motions, state + share @ corners * made.half, thrust)
    assert kept.min() >= answer.margin_m - 1e-9


def test_a_failing_solver_is_never_a_go(monkeypatch: pytest.MonkeyPatch) -> None:
    state, made = start(0.0, 40.0), family(rate=1.0)
    assert decide_for_all(made, state).verdict is Verdict.GO
    calls, real = iter(range(1000)), search.solve
    middle = decide(made.question, state, verdict_only=True).iterations

    def fails(*given: object, **how: bool) -> Solved:
        return real(*given, **how) if next(calls) < middle else Solved("NumericalError")  # type: ignore[arg-type]

    monkeypatch.setattr(stay, "narrow", lambda *_: (False, *[None] * 7))
    monkeypatch.setattr(search, "solve", fails)
    answer = decide_for_all(made, state)
    assert answer.verdict is Verdict.UNDECIDED
    assert "NumericalError" in answer.reason


def test_sets_too_wide_for_the_bounds_are_undecided() -> None:
    state = start(0.0, 40.0)
    wide = Family(Question(Scenario.of(3.0, 0.1), steps=300), tumble_rate=0.03)
    answer = decide_for_all(wide, state)
    assert answer.verdict is not Verdict.GO
    slow = Family(Question(Scenario.of(0.0, 0.1, 1.2e-3), 3.0, 400), mean_motion=1e-4)
    answer = decide_for_all(slow, state)
    assert answer.verdict is Verdict.UNDECIDED
    assert "mean motions" in answer.reason


@pytest.mark.parametrize(
    "widths",
    [
        {"tumble_rate": -1e-3},
        {"tumble_rate": 1.0},
        {"tumble_rate": math.nan},
        {"max_acceleration": 0.1},
        {"mean_motion": 2e-3},
        {"mean_motion": 5e-4},
        {"start": (1.0,)},
        {"start": (1.0, 1.0, -0.1, 0.0)},
        {"start": (1.0, math.inf, 0.1, 0.0)},
    ],
)
def test_bad_widths(widths: dict[str, float]) -> None:
    with pytest.raises(InvalidInput, match="half_width"):
        Family(Question(Scenario.of(3.0, 0.1)), **widths)  # type: ignore[arg-type]


def test_bad_witness() -> None:
    with pytest.raises(InvalidInput, match="witness"):
        decide_for_all(family(), start(0.0, 40.0), witness="all")  # type: ignore[arg-type]


def test_a_sinusoid_between_two_of_its_values() -> None:
    rng = np.random.default_rng(7)
    for _ in range(200):
        size, phase, middle, delta = rng.uniform(0.0, 50.0), *rng.uniform(0.0, 6.0, 2), rng.uniform(0.0, 1.4)
        offset = rng.uniform(-1.0, 2.0)
        x = middle + delta * np.linspace(-1.0, 1.0, 201)
        value = offset - size * np.cos(x - phase)
        ends = np.array([min(value[0], value[-1])])
        bound = turned(ends, np.array([offset]), np.array([True]), delta)[0]
        assert value.min() >= bound - 1e-9
        if ends[0] >= offset:
            assert bound == ends[0]


def test_reach_bounds_flights_and_their_second_derivative_in_the_mean_motion() -> None:
    rng = np.random.default_rng(8)
    for steps in (30, 150):
        for d in (2, 3):
            question = Question(Scenario.of(0.0, 0.1), steps=steps, dimensions=d)
            state = np.concatenate([rng.uniform(-80.0, 80.0, d), rng.uniform(-1.0, 1.0, d)])
            thrust = np.tile(0.1 * state[d:] / np.linalg.norm(state[d:]), (steps, 1))
            far, fast = (float(np.linalg.norm(part)) for part in (state[:d], state[d:]))
            bounds = reach(far, fast, 0.1, 1.2e-3, question.horizon)
            gap = 1e-4
            paths = [_path(question, n, state, thrust) for n in (1e-3, 1e-3 + gap, 1e-3 + 2 * gap)]
            times = question.dt * np.arange(1, steps + 1)
            for path in paths:
                assert (np.linalg.norm(path, axis=1) <= bounds.within(times)).all()
            bend = np.linalg.norm(paths[0] - 2.0 * paths[1] + paths[2], axis=1) / gap**2
            assert bounds.bend / 300.0 < bend.max() <= bounds.bend


def _path(question: Question, n: float, state: Floats, thrust: Floats) -> Floats:
    prediction = prediction_of(Cwh(n), question.dt, question.steps, question.dimensions, 1)
    out: Floats = prediction.flight(state, thrust)[:, 1, : question.dimensions]
    return out


def test_nodes() -> None:
    assert nodes(1.0, 1.0, 5) == (1.0,)
    assert nodes(0.1, 0.4, 3)[0::3] == (0.1, 0.4)
    assert half_angle(nodes(0.1, 0.4, 3), 60.0) == pytest.approx(3.0)
    assert chord_gap((1.0,), 5.0) == 0.0
    assert chord_gap((1.0, 3.0), 5.0) == 2.5

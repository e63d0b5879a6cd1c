"""Synchronize, speed limit, keep-out: flown witnesses, another solver, every end alone, and what must be monotone."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.peers.flown import fly
from safestart.atlas.survey import build
from safestart.attitude.body_frame import rotation
from safestart.disturbance.tube import Disturbance, tube_of
from safestart.dynamics.cwh import planar_transition
from safestart.errors import InvalidInput
from safestart.exact import search
from safestart.exact.answer import Answer, Verdict
from safestart.exact.decide import decide
from safestart.exact.prove import proof_of
from safestart.exact.question import Goal, Question
from safestart.model.scenario import Chaser, CorridorShape, Floats, Scenario, Target
from safestart.optim.largest_margin import Solved
from safestart.proofs.single import check
from tests.unit.exact.socp_polygons import margin

GOAL = Goal(hold=(0.0, 2.0))


def start(x: float, y: float, *velocity: float) -> Floats:
    return np.array([x, y, *(velocity or (0.0, 0.0))])


PLANAR = [
    (1.0, 0.1, start(5.0, 30.0), Verdict.GO),
    (3.0, 0.1, start(8.0, 30.0, 0.2, -0.3), Verdict.GO),
    (2.0, 0.05, start(-10.0, 50.0), Verdict.GO),
    (2.0, 0.1, start(20.0, 148.0), Verdict.NO_GO),
    (1.0, 0.02, start(20.0, 148.0), Verdict.NO_GO),
    (5.0, 0.02, start(0.0, 30.0), Verdict.NO_GO),
]


@pytest.mark.parametrize(("rate", "a_max", "state", "verdict"), PLANAR)
def test_up_to_200_s(rate: float, a_max: float, state: Floats, verdict: Verdict) -> None:
    question = Question(Scenario.of(rate, a_max), steps=100, goal=GOAL)
    answer = decide(question, state)
    assert answer.verdict is verdict
    assert check(proof_of(question, state, answer)).verdict == verdict.value
    if verdict is Verdict.GO:
        assert answer.thrust is not None
        assert fly(question, state, answer.thrust) == pytest.approx(answer.margin_m, abs=1e-6)
        assert answer.upper <= GOAL.radius
    else:
        assert (answer.parts[0].first, answer.parts[-1].last) == (1, 100)
        assert answer.margin_m == answer.upper < 0.0


@pytest.mark.parametrize("speed", [None, 0.6, 2.0])
def test_in_space(speed: float | None) -> None:
    question = Question(Scenario.of(2.0, 0.1), 2.0, 60, 3, Goal(), speed)
    seen = set()
    for state in (
        [4.0, 30.0, 3.0, 0.0, 0.0, 0.0],
        [4.0, 30.0, 3.0, 0.3, -0.3, 0.1],
        [50.0, 90.0, 9.0, 0, 0, 0],
    ):
        at = np.array(state)
        answer = decide(question, at)
        seen.add(answer.verdict)
        assert check(proof_of(question, at, answer)).verdict == answer.verdict.value
        if answer.thrust is not None:
            assert fly(question, at, answer.thrust) == pytest.approx(answer.margin_m, abs=1e-6)
    assert seen <= {Verdict.GO, Verdict.NO_GO}
    assert speed is None or Verdict.NO_GO in seen
    assert speed == 0.6 or Verdict.GO in seen


@pytest.mark.parametrize("speed", [0.5, 1.0, 3.0])
def test_staying_with_a_speed_limit(speed: float) -> None:
    free, limited = (Question(Scenario.of(2.0, 0.1), speed_limit=limit) for limit in (None, speed))
    for state in (start(5.0, 40.0), start(-20.0, 60.0, 0.2, 0.1), start(5.0, 20.0, 0.3, -0.3)):
        one, two = decide(free, state), decide(limited, state)
        assert two.gap <= 1e-4
        assert two.lower <= one.upper
        assert check(proof_of(limited, state, two)).verdict == two.verdict.value
        if two.thrust is not None:
            assert fly(limited, state, two.thrust) == pytest.approx(two.margin_m, abs=1e-6)


def test_a_start_too_fast_is_refused_at_once() -> None:
    question = Question(Scenario.of(2.0, 0.1), speed_limit=0.5, goal=Goal())
    state = start(0.0, 40.0, 0.3, -0.5)
    answer = decide(question, state)
    assert (answer.verdict, answer.iterations) == (Verdict.NO_GO, 0)
    assert answer.margin_m == pytest.approx(10.0 * (0.5 - math.hypot(0.3, 0.5)))
    assert [m.face for m in answer.parts[0].multipliers] == ["speed"]
    check(proof_of(question, state, answer))
    staying = replace(question, goal=None)
    check(proof_of(staying, state, decide(staying, state)))


@pytest.mark.parametrize(("steps", "speed"), [(10, None), (20, None), (20, 1.0)])
def test_the_linear_program_brackets_each_end(steps: int, speed: float | None) -> None:
    goal = replace(GOAL, earliest=steps)
    for rate, a_max, state, _ in [*PLANAR[:4], (3.0, 0.1, start(3.0, 9.0), None)]:
        question = Question(Scenario.of(rate, a_max), 2.0, steps, 2, goal, speed)
        answer = decide(question, state)
        # A polygon of 32 sides differs by half a percent, samples 0.5 s apart by some centimetres.
        inner, outer = (margin(question, state, outer=side) for side in (False, True))
        assert answer.lower <= outer + 1e-6
        assert inner <= answer.upper + 0.05
        assert answer.gap <= max(1e-4, -0.1 * answer.upper)
        assert outer - inner < 0.02 * (30.0 + abs(outer))


def test_every_end_alone_gives_the_answer_of_all() -> None:
    """Brute force over T, and starts for which only some T will do."""
    rng = np.random.default_rng(4)
    cases = [(Goal(), start(*rng.uniform([-6, 4], [6, 20]), *rng.uniform(-0.4, 0.4, 2))) for _ in range(8)]
    # At rest at 60 m for a moment only, after 4 s: to stay there asks for 0.46 m/s^2.
    w = math.radians(5.0)
    at = rotation(4.0 * w) @ [0.0, 60.0]
    moment = np.array([*at, -w * at[1], w * at[0]])
    cases.append((Goal(hold=(0.0, 60.0)), planar_transition(1.1e-3, -4.0) @ moment))
    verdicts = []
    for goal, state in cases:
        question = Question(Scenario.of(5.0, 0.1), 2.0, 14, 2, goal)
        alone = [
            decide(replace(question, steps=k, goal=replace(goal, earliest=k)), state) for k in range(1, 15)
        ]
        answer = decide(question, state)
        verdicts.append(answer.verdict)
        go = [one.verdict is Verdict.GO for one in alone]
        assert (answer.verdict is Verdict.GO) == any(go)
        assert answer.upper >= max(one.lower for one in alone)
        assert answer.lower <= max(one.upper for one in alone)
        if answer.thrust is not None:
            assert go[len(answer.thrust) - 1]
        check(proof_of(question, state, answer))
    assert set(verdicts) == {Verdict.GO, Verdict.NO_GO}
    assert answer.thrust is not None
    assert len(answer.thrust) == 2


def bracket(state: Floats, steps: int = 20, **change: object) -> Answer:
    goal = replace(GOAL, earliest=steps, **change)
    return decide(Question(Scenario.of(2.0, 0.05), 2.0, steps, 2, goal), state)


def test_monotone_in_ball_rest_and_bound() -> None:
    for state in (start(4.0, 12.0), start(3.0, 16.0), start(2.0, 22.0, 0.0, -0.3)):
        base = bracket(state)
        wider = bracket(state, radius=1.0, rest=0.1)
        # The same scale of 10 s: half a metre more for the ball and for the rest, nothing more for the faces.
        assert base.lower <= wider.upper
        assert wider.lower <= base.upper + 0.5 + 1e-9
        # Faster at the end is easier; it is measured in other metres, so the verdict is what can be compared.
        faster = bracket(state, rest=0.5)
        assert base.verdict is not Verdict.GO or faster.verdict is Verdict.GO
        verdicts = [
            decide(Question(Scenario.of(2.0, 0.05), 2.0, k, 2, GOAL), state).verdict for k in (5, 10, 20, 40)
        ]
        assert verdicts == sorted(verdicts, key=[Verdict.NO_GO, Verdict.GO].index)
        assert Verdict.NO_GO in verdicts


def test_starts_that_synchronize_at_one_end_are_convex() -> None:
    rng = np.random.default_rng(8)
    for _ in range(10):
        a, b = (start(*rng.uniform([-12, 8], [12, 30]), *rng.uniform(-0.3, 0.3, 2)) for _ in range(2))
        share = rng.uniform()
        ends = share * bracket(a).lower + (1.0 - share) * bracket(b).lower
        assert bracket(share * a + (1.0 - share) * b).upper >= ends - 1e-9


def test_synchronize_asks_more_than_staying() -> None:
    for rate, a_max, state, verdict in PLANAR:
        if verdict is Verdict.GO:
            scenario = Scenario.of(rate, a_max)
            found = decide(Question(scenario, goal=GOAL, steps=60), state)
            assert found.thrust is not None
            staying = decide(Question(scenario, steps=len(found.thrust)), state)
            assert staying.upper >= found.lower


def test_without_tumble_and_other_shapes() -> None:
    shape = CorridorShape(1.2, 0.7, 3.0, 2.0, 1.0)
    for rate, n in ((0.0, 0.0), (0.0, 1.1e-3), (0.02, 1.3e-3)):
        scenario = Scenario(Target(rate, n), Chaser(0.1), shape)
        for d in (2, 3):
            state = np.zeros(2 * d)
            state[:2] = 3.0, 20.0
            question = Question(scenario, 1.5, 40, d, Goal(), 2.0)
            answer = decide(question, state)
            assert answer.verdict is Verdict.GO
            assert answer.thrust is not None
            assert fly(question, state, answer.thrust) == pytest.approx(answer.margin_m, abs=1e-6)
            check(proof_of(question, state, answer))


@pytest.mark.parametrize("dt", [0.1, 0.7, 1.1])
def test_ends_that_are_no_doubles(dt: float) -> None:
    """k dt rounds to a double after the exact end: the proof counts the same rows as the search did."""
    for rate, state in ((3.0, start(0.0, 9.0)), (3.0, start(6.0, 9.0, 0.4, 0.3)), (5.0, start(3.0, 60.0))):
        question = Question(Scenario.of(rate, 0.05), dt, 30, 2, Goal(), 1.0)
        answer = decide(question, state)
        assert check(proof_of(question, state, answer)).verdict == answer.verdict.value


def test_keep_out_is_the_hold_plane_or_refused() -> None:
    scenario, state = Scenario.of(1.0, 0.1), start(0.0, 30.0)
    inside = Question(scenario, keep_out=0.5)
    answer = decide(inside, state)
    assert answer == replace(decide(Question(scenario), state), thrust=answer.thrust)
    assert check(proof_of(inside, state, answer)).verdict == "GO"
    with pytest.raises(InvalidInput, match="not convex") as error:
        Question(scenario, keep_out=0.6)
    assert error.value.field == "keep_out"


def test_a_failing_solver_is_never_a_go(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "solve", lambda *_, **__: Solved("NumericalError"))
    answer = decide(Question(Scenario.of(1.0, 0.1), steps=4, goal=Goal()), start(0.0, 5.0))
    assert answer.verdict is Verdict.UNDECIDED
    assert "NumericalError" in answer.reason
    assert answer.thrust is None
    assert not answer.parts


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"goal": Goal(hold=(0.0, 0.4))}, "hold"),
        ({"goal": Goal(hold=(0.0, 2.0, 0.0))}, "hold"),
        ({"goal": Goal(hold=(0.0, math.nan))}, "hold"),
        ({"goal": Goal(earliest=31)}, "earliest"),
        ({"goal": Goal(earliest=0)}, "earliest"),
        ({"speed_limit": 0.0}, "speed_limit"),
        ({"speed_limit": math.nan}, "speed_limit"),
        ({"keep_out": -1.0}, "keep_out"),
    ],
)
def test_bad_questions(change: dict[str, object], field: str) -> None:
    with pytest.raises(InvalidInput) as error:
        Question(Scenario.of(1.0, 0.1), **change)  # type: ignore[arg-type]
    assert error.value.field == field


@pytest.mark.parametrize("change", [{"radius": 0.0}, {"radius": math.inf}, {"rest": 0.0}, {"rest": True}])
def test_bad_goals(change: dict[str, float]) -> None:
    with pytest.raises(InvalidInput):
        Goal(**change)


@pytest.mark.parametrize("change", [{"goal": Goal()}, {"speed_limit": 1.0}])
def test_atlas_and_tube_refuse_what_they_do_not_answer(change: dict[str, object]) -> None:
    question = Question(Scenario.of(1.0, 0.1), **change)  # type: ignore[arg-type]
    with pytest.raises(InvalidInput):
        build(question)
    with pytest.raises(InvalidInput):
        tube_of(question, Disturbance(1e-4))

"""The compiled parts of exact answers beside the same written with arrays."""

import math

import numpy as np
import pytest

from safestart.constraints.cubic import dips
from safestart.dynamics.cwh import Cwh
from safestart.exact import speed
from safestart.exact.answer import Verdict
from safestart.exact.decide import answer_of, decide
from safestart.exact.kernels import stay as compiled
from safestart.exact.kernels.minima import below_cubics, derivative_bounds
from safestart.exact.prove import proof_of
from safestart.exact.question import Question
from safestart.exact.search import Search
from safestart.exact.watch import Minima, Watch, watch_of
from safestart.model.scenario import Chaser, CorridorShape, Floats, Scenario, Target
from safestart.optim import ball_margin
from safestart.optim.largest_margin import SOLVED_BY
from safestart.proofs.single import check


def drawn(seed: int, *, speed_limit: bool = False) -> tuple[Question, Floats]:
    """A question in the plane or in space, some without tumble or mean motion, and a start in its corridor."""
    rng = np.random.default_rng(seed)
    d = int(rng.integers(2, 4))
    rate = math.radians(float(rng.choice([0.0, 0.3, 1.0, 3.0, 5.0])))
    shape = CorridorShape(c_x=float(rng.uniform(0.3, 3.0)))
    scenario = Scenario(
        Target(rate, float(rng.choice([0.0, 1.1e-3]))), Chaser(10.0 ** float(rng.uniform(-3, -1))), shape
    )
    steps = int(rng.choice([1, 2, 7, 30, 60]))
    limit = float(rng.uniform(0.5, 5.0)) if speed_limit else None
    question = Question(scenario, float(rng.choice([1.0, 2.0, 7.3])), steps, d, speed_limit=limit)
    far = float(rng.uniform(10.0, 150.0))
    state = np.zeros(2 * d)
    state[:2] = 0.6 * far * shape.c_x * rng.uniform(-1.0, 1.0), far
    state[d:] = rng.normal(size=d) * float(rng.choice([0.0, 0.2]))
    return question, state


def by_arrays(watch: Watch, state: Floats, thrust: Floats) -> Minima:
    """``Watch.minima`` without a compiled part but the bounds between samples."""
    d, h, limit = watch.question.dimensions, watch.step, watch.question.speed_limit
    flown = watch.prediction.flight(state, thrust)
    value, slope = watch.along_normals(flown)
    value += watch.offsets
    if limit is not None:
        left, closing = speed.room(limit, watch.mean_motion, h, flown, thrust)
        value, slope = np.concatenate([value, left], axis=-1), np.concatenate([slope, closing], axis=-1)
    low, at = dips(value, slope)
    low, at = low.reshape(-1, low.shape[-1]), at.reshape(-1, low.shape[-1])
    fence = np.full((1, low.shape[1]), np.inf)
    before, after = np.concatenate([fence, low[:-1]]), np.concatenate([low[1:], fence])
    index, face = np.nonzero((low <= before) & (low < after))
    times = watch.times[:, :-1].ravel()[index] + h * at[index, face]
    most = [float(np.linalg.norm(part, axis=-1).max()) for part in (flown[..., :d], flown[..., d:], thrust)]
    bounds = derivative_bounds(watch.mean_motion, h, *most)
    lowest = float(low[:, : len(watch.names)].min()) - below_cubics(watch.rate, h, bounds)
    if limit is not None:
        lost = speed.bend(watch.mean_motion, bounds) * h**4 / 384.0
        lowest = min(lowest, float(speed.metres(limit, low[:, -1].min() - lost)))
        low[:, -1] = speed.metres(limit, low[:, -1])
    return Minima(lowest, np.minimum(times, watch.question.horizon), face, low[index, face])


@pytest.mark.parametrize("seed", range(40))
def test_the_minima_are_those_of_the_arrays(seed: int) -> None:
    question, state = drawn(seed, speed_limit=seed % 3 == 0)
    watch = Watch(question, phase=0.1 * seed)
    rng = np.random.default_rng(seed)
    thrust = rng.normal(size=(question.steps, question.dimensions)) * question.largest_thrust / 3.0
    ours, theirs = watch.minima(state, thrust), by_arrays(watch, state, thrust)
    assert ours.lowest == pytest.approx(theirs.lowest, rel=1e-12, abs=1e-11)
    if len(ours.times) == len(theirs.times):
        np.testing.assert_array_equal(ours.faces, theirs.faces)
        np.testing.assert_allclose(ours.values, theirs.values, rtol=1e-11, atol=1e-9)
        np.testing.assert_allclose(ours.times, theirs.times, atol=1e-4)
    else:
        # A distance that hardly changes has minima made of rounding alone.
        assert np.ptp(theirs.values) < 1e-9 or question.scenario.target.tumble_rate == 0.0


@pytest.mark.parametrize("seed", range(40))
def test_the_rows_are_those_of_the_arrays(seed: int) -> None:
    question, _ = drawn(seed)
    watch = Watch(question, phase=-0.2 * seed)
    rng = np.random.default_rng(seed)
    times = np.concatenate([[0.0, question.horizon, question.dt], rng.uniform(0.0, question.horizon, 9)])
    faces = rng.integers(0, len(watch.names), len(times))
    cuts = watch.cuts(times, faces)
    angle = watch.phase + watch.rate * times
    c, s = np.cos(angle), np.sin(angle)
    body = watch.normals[faces]
    normal = -body
    normal[:, 0], normal[:, 1] = s * body[:, 1] - c * body[:, 0], -s * body[:, 0] - c * body[:, 1]
    start, thrust = watch.prediction.position_rows(times, normal)
    np.testing.assert_allclose(cuts.start, start, rtol=1e-12, atol=1e-12 * np.abs(start).max())
    np.testing.assert_allclose(cuts.thrust, thrust, rtol=1e-12, atol=1e-12 * np.abs(thrust).max())
    np.testing.assert_array_equal(cuts.offset, watch.offsets[faces])


def test_long_intervals_leave_the_series_of_the_motion() -> None:
    """Over more than half a radian of the orbit the closed forms are not summed as series."""
    scenario = Scenario(Target(0.0, 1.1e-3), Chaser(0.01), CorridorShape())
    watch = Watch(Question(scenario, 700.0, 3, 3))
    times = np.array([650.0, 1400.0, 2099.0])
    cuts = watch.cuts(times, np.array([0, 1, 2]))
    for row, time in enumerate(times.tolist()):
        phi = Cwh(1.1e-3).transition(0.0, time)[:3]
        np.testing.assert_allclose(cuts.start[row], -watch.normals[row] @ phi, rtol=1e-11, atol=1e-9)


@pytest.mark.parametrize("seed", range(60))
@pytest.mark.parametrize("verdict_only", [False, True])
def test_the_answer_is_that_of_the_search(seed: int, verdict_only: bool) -> None:
    question, state = drawn(seed)
    before = SOLVED_BY.copy()
    answer = decide(question, state, verdict_only=verdict_only)
    assert (SOLVED_BY - before).keys() <= {"compiled"}
    search = Search(watch_of(question), state)
    if search.distance_now < 0.0:
        assert answer.verdict is Verdict.NO_GO
        return
    theirs = answer_of(search, search.narrow(1e-4, verdict_only=verdict_only))
    assert answer.verdict is theirs.verdict
    # Both brackets hold the same number.
    slack = 1e-9
    assert answer.lower <= theirs.upper + slack
    assert theirs.lower <= answer.upper + slack
    if not verdict_only and answer.verdict is not Verdict.UNDECIDED:
        assert answer.gap <= 1e-4
    if answer.verdict is not Verdict.UNDECIDED:
        check(proof_of(question, state, answer))


def test_what_is_left_open_is_searched_for(monkeypatch: pytest.MonkeyPatch) -> None:
    question, state = drawn(3)
    answer = decide(question, state)
    monkeypatch.setattr(compiled, "narrow", lambda *_: (False, *[None] * 7))
    monkeypatch.setattr(
        ball_margin, "largest_margin", lambda *_: (np.zeros(1), np.zeros(1), ball_margin.SLOW, 0)
    )
    before = SOLVED_BY.copy()
    theirs = decide(question, state)
    assert (SOLVED_BY - before).keys() == {"open"}
    assert theirs.verdict is answer.verdict
    assert theirs.upper == pytest.approx(answer.upper, abs=1e-4)


@pytest.mark.parametrize("value", [1e200, -1e200])
def test_what_overflows_is_no_verdict_of_the_compiled_part(value: float) -> None:
    """The door refuses such states; the compiled part does not rely on it."""
    question, state = drawn(3)
    state[0], state[question.dimensions] = 0.0, value
    assert compiled.stay(watch_of(question), state, 1e-4, verdict_only=False) is None

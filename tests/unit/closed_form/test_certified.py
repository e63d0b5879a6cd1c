"""`certified`: one answer by three ways in, refusals, edges, what the paper's conditions get wrong, coverage."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safestart.closed_form.certified import ROUNDING, certify, certify_grid
from safestart.closed_form.certified_point import certify_point, prepare
from safestart.closed_form.paper import certify as paper_certify
from safestart.constraints.corridor import corridor_of
from safestart.errors import InvalidInput
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.exact.question import Question
from safestart.model.scenario import Chaser, CorridorShape, Grid, Rest, Scenario, Target

rates = st.one_of(st.just(0.0), st.floats(1e-4, 20.0))
thrusts = st.floats(-6.0, 0.0).map(lambda decade: 10.0**decade)
rests = st.sampled_from(list(Rest))

WRONG = [
    # deg/s, m/s^2, start (m), c_x, horizon (s): certified by the paper's conditions and proved NO_GO.
    (0.0, 1e-3, (590.0, 400.0), 1.5, 300.0),
    (2.0, 0.05, (9.364, 81.044), 1.5, 60.0),
    (1.7656, 0.0781, (28.6, 94.099, -131.669), 1.5, 60.0),
    (0.9143000086398368, 0.7714300075428178, (-341.2251412395135, 3314.8831489690588), 0.4, 60.0),
]


@pytest.mark.parametrize(("rate", "thrust", "start", "slope", "horizon"), WRONG)
def test_what_cannot_be_flown_is_not_certified(
    rate: float, thrust: float, start: tuple[float, ...], slope: float, horizon: float
) -> None:
    scenario = Scenario(Target(math.radians(rate), 1.1e-3), Chaser(thrust), CorridorShape(c_x=slope))
    point = np.array(start)
    assert bool(paper_certify(scenario, point).safe)
    question = Question(scenario, horizon / 60, 60, len(start))
    state = np.concatenate([point, np.zeros(len(start))])
    assert decide(question, state, verdict_only=True).verdict is Verdict.NO_GO
    found = certify(scenario, point)
    assert not bool(found.go)
    assert float(found.margin) <= 0.0


@pytest.mark.parametrize("rest", list(Rest))
def test_starts_on_its_edge_are_go_by_the_exact_answer(rest: Rest) -> None:
    """Ten minutes, thrust held; `benchmarks/certified.py` does this for as many as one has time for."""
    for rate, thrust, n in ((0.0, 2e-3, 1.1e-3), (0.02, 3e-4, 1.1e-3), (1.0, 0.01, 1.1e-3), (2.0, 0.1, 0.0)):
        scenario = Scenario.of(rate, thrust, n)
        omega = scenario.target.tumble_rate
        unit = min(thrust / (omega + n) ** 2, 2000.0)
        question = Question(scenario, 6.0 if rate < 1.0 else 1.5, 100 if rate < 1.0 else 400)
        for angle in (-0.9, -0.3, 0.2, 0.7):
            low, high = 0.0, 5.0
            for _ in range(40):
                middle = 0.5 * (low + high)
                point = np.array([0.0, 1.0]) + middle * unit * np.array([math.sin(angle), math.cos(angle)])
                if bool(certify(scenario, point, rest).go):
                    low = middle
                else:
                    high = middle
            point = np.array([0.0, 1.0]) + low * unit * np.array([math.sin(angle), math.cos(angle)])
            if float(np.linalg.norm(point)) > 1e4:
                continue
            velocity = omega * np.array([-point[1], point[0]]) if rest is Rest.BODY else np.zeros(2)
            answer = decide(question, np.concatenate([point, velocity]), verdict_only=True)
            assert answer.verdict is Verdict.GO, (rate, angle, point)


@given(rates, thrusts, rests, st.integers(0, 2**32 - 1), st.booleans())
def test_the_point_and_the_array_agree(
    rate: float, thrust: float, rest: Rest, seed: int, spatial: bool
) -> None:
    scenario = Scenario.of(rate, thrust)
    rng = np.random.default_rng(seed)
    unit = min(thrust / (scenario.target.tumble_rate + 1.1e-3) ** 2, 1e5)
    points = unit * rng.uniform([-2.0, 0.0, -1.0], [2.0, 4.0, 1.0], (20, 3))[:, : 3 if spatial else 2]
    found = certify(scenario, points, rest)
    given_ = prepare(scenario.target.tumble_rate, 1.1e-3, thrust, scenario.corridor, rest, spatial)
    for i, point in enumerate(points.tolist()):
        one = certify_point(given_, *point)
        assert (one.margin, one.go) == (found.margin[i], bool(found.go[i]))
        assert one.binding == found.names[int(found.binding[i])]
        assert one.member == int(found.member[i]) or one.margin < 0.0


@given(rates, thrusts, rests)
def test_the_map_is_the_pointwise_answer(rate: float, thrust: float, rest: Rest) -> None:
    scenario, grid = Scenario.of(rate, thrust), Grid(13, 9, 60.0)
    region = certify_grid(scenario, grid, rest)
    points = grid.points(scenario.corridor)
    found = certify(scenario, points, rest)
    np.testing.assert_array_equal(region.margin, found.margin)
    np.testing.assert_array_equal(region.mask, found.go)
    np.testing.assert_array_equal(region.inside, corridor_of(scenario.corridor).contains(points))
    assert not (region.mask & ~region.inside).any()
    assert region.safe_fraction == pytest.approx(region.mask.sum() / region.inside.sum())


def test_in_the_plane_the_third_coordinate_changes_nothing() -> None:
    """A start at z = 0 has the same certificate in 2-D and 3-D."""
    scenario = Scenario.of(3.0, 0.1)
    flat = Grid(21, 21, 90.0).points(scenario.corridor).reshape(-1, 2)
    solid = np.concatenate([flat, np.zeros((len(flat), 1))], axis=-1)
    for rest in Rest:
        two, three = certify(scenario, flat, rest), certify(scenario, solid, rest)
        np.testing.assert_array_equal(two.go, three.go)
        np.testing.assert_allclose(three.margin[two.go], two.margin[two.go], atol=1e-9)


def test_above_and_below_the_plane_are_alike() -> None:
    scenario = Scenario.of(2.0, 0.1)
    rng = np.random.default_rng(2)
    points = rng.uniform([-80, 1, -80], [60, 120, 80], (500, 3))
    up, down = certify(scenario, points), certify(scenario, points * [1.0, 1.0, -1.0])
    np.testing.assert_array_equal(up.margin, down.margin)
    assert 50 < up.go.sum() < 450


def test_without_any_rotation_all_of_the_corridor_is_certified() -> None:
    """No tumble, no orbit: standing still needs no thrust, and the margin is the start's own."""
    scenario = Scenario(Target(0.0, 0.0), Chaser(1e-6))
    points = np.array([[0.0, 9000.0], [100.0, 80.0], [2.0, 0.6]])
    for rest in Rest:
        found = certify(scenario, points, rest)
        assert found.go.all()
        own = corridor_of(scenario.corridor).slack(points) / corridor_of(scenario.corridor).lengths
        np.testing.assert_allclose(found.margin, own.min(axis=-1) - ROUNDING, atol=1e-9)


def test_without_tumble_the_along_track_axis_is_free() -> None:
    """A start on +y stays without thrust; x costs 3 n^2, z costs n^2, together as the disk says."""
    n, thrust = 1.1e-3, 1e-4
    scenario = Scenario(Target(0.0, n), Chaser(thrust))
    farthest = thrust / (3.0 * n * n)
    points = np.array([[0.0, 9000.0, 0.0], [farthest - 1e-3, 5000.0, 0.0], [0.5 * farthest, 5000.0, 0.0]])
    assert certify(scenario, points).go.all()
    beyond = np.array([[1.3 * farthest, 5000.0, 0.0], [0.9 * farthest, 5000.0, 2.0 * farthest]])
    assert not certify(scenario, beyond).go.any()


def test_the_edge_of_the_corridor_is_not_inside() -> None:
    scenario = Scenario.of(1.0, 0.1)
    edges = np.array([[0.0, 0.5], [1.0, 0.5], [76.75, 50.0], [0.0, 0.49], [-76.75, 50.0]])
    found = certify(scenario, edges, Rest.BODY)
    assert not found.go.any()
    assert [found.names[i] for i in found.binding] == [
        "hold_plane",
        "hold_plane",
        "right",
        "hold_plane",
        "left",
    ]
    within = certify(scenario, np.array([76.7, 50.0]), Rest.BODY)
    assert bool(within.go)
    assert float(within.margin) == pytest.approx(0.05 / math.hypot(1.0, 1.5), abs=2e-6)


def test_out_of_reach_says_so_in_metres() -> None:
    scenario = Scenario.of(5.0, 0.01)
    found = certify(scenario, np.array([[0.0, 50.0], [0.0, 40.0]]))
    assert [found.names[i] for i in found.binding] == ["range", "range"]
    assert float(found.margin[1] - found.margin[0]) == pytest.approx(10.0)
    assert (found.margin < 0.0).all()


@pytest.mark.filterwarnings("error")
def test_a_height_that_takes_more_than_the_thrust_is_out_of_reach_without_a_warning() -> None:
    scenario = Scenario(Target(math.radians(10.0)), Chaser(1e-6))
    found = certify(scenario, np.array([[0.0, 5000.0, 4000.0], [0.0, 9000.0, 9000.0]]))
    assert not found.go.any()
    assert (found.margin < 0.0).all()


def test_every_shape_of_array_and_none() -> None:
    scenario = Scenario.of(2.0, 0.1)
    assert certify(scenario, np.zeros((0, 2))).go.shape == (0,)
    assert certify(scenario, np.zeros((0, 3)), Rest.BODY).margin.shape == (0,)
    assert certify(scenario, np.array([0.0, 10.0])).go.shape == ()
    assert certify(scenario, np.full((2, 3, 2), 10.0)).binding.shape == (2, 3)
    assert not certify_grid(scenario, Grid(2, 2, 0.6)).mask.any()


@pytest.mark.parametrize("points", [[math.nan, 1.0], [0.0, math.inf], [1.0, 2.0, 3.0, 4.0], 3.0, [2e6, 3e6]])
def test_what_is_no_place_is_refused(points: object) -> None:
    with pytest.raises(InvalidInput):
        certify(Scenario.of(1.0, 0.1), np.array(points))


def test_what_is_no_place_or_scenario_is_refused_for_one_start() -> None:
    shape = CorridorShape()
    ready = prepare(0.01, 1.1e-3, 0.1, shape, Rest.LVLH, True)
    for place in ((math.nan, 1.0, 0.0), (0.0, math.inf, 0.0), (0.0, 10.0, math.nan), (2e6, 3e6, 0.0)):
        with pytest.raises(InvalidInput):
            certify_point(ready, *place)
    for omega, n, thrust in ((-0.01, 1e-3, 0.1), (0.01, math.nan, 0.1), (0.01, 1e-3, 0.0)):
        with pytest.raises(InvalidInput):
            prepare(omega, n, thrust, shape, Rest.LVLH, False)


@pytest.mark.parametrize("rate", [1.0, 2.0, 3.0, 4.0, 5.0])
@pytest.mark.parametrize("thrust", [0.20, 0.10, 0.05, 0.01])
def test_it_keeps_nine_tenths_of_the_papers_region_and_adds_to_it(rate: float, thrust: float) -> None:
    """Table 1's points, 201 x 201 over the corridor up to 150 m or the paper's range limit. All cells: docs/theory."""
    scenario = Scenario.of(rate, thrust)
    grid = Grid(201, 201, min(150.0, max(1.02 * scenario.sync_radius, 1.0)))
    points = grid.points(scenario.corridor)
    theirs, ours = paper_certify(scenario, points).safe, certify_grid(scenario, grid).mask
    assert (ours & theirs).sum() >= 0.90 * theirs.sum()
    assert ours.sum() >= 1.04 * theirs.sum()
    body = paper_certify(scenario, points, Rest.BODY).safe
    assert not (body & ~certify_grid(scenario, grid, Rest.BODY).mask).any()

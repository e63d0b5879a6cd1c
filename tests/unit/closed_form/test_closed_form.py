"""The certificate: brute force, properties, 2-D against 3-D, bad input, and the body-rest extension."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safestart.attitude.body_frame import body_to_lvlh
from safestart.closed_form.paper import certify, certify_grid, range_limit
from safestart.constraints.corridor import FACES, corridor_of
from safestart.errors import InvalidInput
from safestart.model.scenario import CorridorShape, Grid, Rest, Scenario
from tests.unit.dynamics.plain_cwh import feedforward

rates = st.floats(0.0, 10.0)
thrusts = st.floats(1e-3, 1.0)
coordinates = st.floats(-200.0, 200.0)


def _by_hand(scenario: Scenario, x: float, y: float) -> tuple[bool, float]:
    """Equations (4), (8), (9) written out for the planar corridor, scalar by scalar."""
    w, a, c = scenario.target.tumble_rate, scenario.chaser.max_acceleration, scenario.corridor
    xdot, ydot = w * y, -w * x
    slacks = [
        y - c.hold_radius,
        c.x0 + c.c_x * (y - c.hold_radius) - x,
        c.x0 + c.c_x * (y - c.hold_radius) + x,
    ]
    slack_rates = [ydot, c.c_x * ydot - xdot, c.c_x * ydot + xdot]
    lengths = [1.0, math.hypot(1, c.c_x), math.hypot(1, c.c_x)]
    margins = [
        (s - min(0.0, d) ** 2 / (2 * a)) / length
        for s, d, length in zip(slacks, slack_rates, lengths, strict=True)
    ]
    reach = 2 * a / w**2 - math.hypot(x, y) if w**2 else math.inf
    margin = min([*margins, reach])
    return margin > 0, margin


@given(rates, thrusts, coordinates, coordinates)
def test_against_the_equations_written_out(rate: float, thrust: float, x: float, y: float) -> None:
    scenario = Scenario.of(rate, thrust)
    answer = certify(scenario, np.array([x, y]))
    safe, margin = _by_hand(scenario, x, y)
    assert float(answer.margin) == pytest.approx(margin, rel=1e-9, abs=1e-9)
    assert bool(answer.safe) == safe or abs(margin) < 1e-9


@given(rates, thrusts, st.sampled_from(list(Rest)))
def test_the_map_is_the_pointwise_answer(rate: float, thrust: float, rest: Rest) -> None:
    scenario, grid = Scenario.of(rate, thrust), Grid(13, 9, 60.0)
    region = certify_grid(scenario, grid, rest)
    points = certify(scenario, grid.points(scenario.corridor), rest)
    np.testing.assert_allclose(region.margin, points.margin, rtol=1e-12, atol=1e-9)
    np.testing.assert_array_equal(region.mask, points.safe)
    np.testing.assert_array_equal(
        region.inside, corridor_of(scenario.corridor).contains(grid.points(scenario.corridor))
    )
    assert region.safe_fraction == region.mask.sum() / region.inside.sum()


@given(st.floats(0.1, 10.0), thrusts, st.floats(0.1, 10.0), coordinates, coordinates)
def test_depends_on_thrust_over_rate_squared_alone(
    rate: float, thrust: float, factor: float, x: float, y: float
) -> None:
    """Scaling: (k omega, k^2 a) gives the same margin."""
    if not (1e-3 <= rate * factor <= 60 and thrust * factor**2 <= 10):
        return
    point = np.array([x, y])
    one = certify(Scenario.of(rate, thrust), point).margin
    two = certify(Scenario.of(rate * factor, thrust * factor**2), point).margin
    assert float(one) == pytest.approx(float(two), rel=1e-9, abs=1e-9)


@given(rates, rates, thrusts, thrusts)
def test_more_thrust_or_less_tumble_never_loses_a_start(r1: float, r2: float, a1: float, a2: float) -> None:
    grid = Grid(21, 21, 100.0)
    hard = certify_grid(Scenario.of(max(r1, r2), min(a1, a2)), grid).mask
    easy = certify_grid(Scenario.of(min(r1, r2), max(a1, a2)), grid).mask
    assert not (hard & ~easy).any()


@given(thrusts, rates)
def test_mirror_symmetry_where_it_holds(thrust: float, rate: float) -> None:
    """Without tumble, and for starts that rotate with the target, left and right are alike."""
    grid = Grid(21, 11, 80.0)
    still = certify_grid(Scenario.of(0.0, thrust), grid)
    np.testing.assert_allclose(still.margin, still.margin[:, ::-1], atol=1e-9)
    corotating = certify_grid(Scenario.of(rate, thrust), grid, Rest.BODY)
    np.testing.assert_allclose(corotating.margin, corotating.margin[:, ::-1], atol=1e-9)


def test_rotation_breaks_the_mirror() -> None:
    mask = certify_grid(Scenario.of(2.0, 0.1), Grid(41, 41, 150.0)).mask
    assert not np.array_equal(mask, mask[:, ::-1])


def test_slack_rate_is_the_derivative_along_the_drift() -> None:
    """Central difference of the slack of an LVLH-resting point seen from the turning frame."""
    scenario = Scenario.of(3.0, 0.1)
    w, h = scenario.target.tumble_rate, 1e-4
    point = np.array([4.0, 30.0, -2.0])
    corridor = corridor_of(scenario.corridor, 3)

    def slack(time: float) -> np.ndarray:
        c, s = math.cos(w * time), math.sin(w * time)
        turned = np.array([c * point[0] + s * point[1], -s * point[0] + c * point[1], point[2]])
        return corridor.slack(turned)

    np.testing.assert_allclose(
        certify(scenario, point).slack_rate, (slack(h) - slack(-h)) / (2 * h), atol=1e-6
    )


def test_three_dimensions_reduce_to_two_at_z_zero_and_see_the_z_faces() -> None:
    scenario = Scenario.of(2.0, 0.1)
    planar = certify(scenario, np.array([5.0, 40.0]))
    spatial = certify(scenario, np.array([5.0, 40.0, 0.0]))
    assert spatial.faces == FACES
    assert float(planar.margin) == pytest.approx(float(spatial.margin))
    high = certify(scenario, np.array([0.0, 10.0, 40.0]))
    assert high.slack[FACES.index("top")] < 0
    assert not high.safe


def test_no_tumble_has_no_range_limit() -> None:
    answer = certify(Scenario.of(0.0, 0.1), np.array([0.0, 5000.0]))
    assert math.isinf(answer.range_limit)
    assert bool(answer.safe)
    assert range_limit(Scenario.of(0.0, 0.1, mean_motion=0.0), Rest.BODY) == math.inf


@given(st.floats(0.0, 10.0), thrusts, st.floats(0.0, 2 * math.pi))
def test_body_rest_limit_is_where_station_keeping_needs_full_thrust(
    rate: float, thrust: float, angle: float
) -> None:
    """Thrust that keeps a point fixed in the body frame never exceeds a_max inside the limit."""
    scenario = Scenario.of(rate, thrust)
    w, n = scenario.target.tumble_rate, scenario.target.mean_motion
    r = range_limit(scenario, Rest.BODY)
    position, velocity = body_to_lvlh(
        np.array([r * math.cos(angle), r * math.sin(angle), 0.0]), np.zeros(3), w, 0.0
    )
    demand = -w * w * position + feedforward(n, position, velocity)
    assert np.linalg.norm(demand) <= thrust * (1 + 1e-9)


@pytest.mark.parametrize("rate", [0.0, 0.5, 3.0])
def test_body_rest_limit_is_reached_on_the_radial_axis(rate: float) -> None:
    scenario = Scenario.of(rate, 0.05)
    w, n = scenario.target.tumble_rate, scenario.target.mean_motion
    place = np.array([range_limit(scenario, Rest.BODY), 0.0, 0.0])
    position, velocity = body_to_lvlh(place, np.zeros(3), w, 0.0)
    demand = -w * w * position + feedforward(n, position, velocity)
    assert np.linalg.norm(demand) == pytest.approx(0.05, rel=1e-12)


@pytest.mark.parametrize("points", [[np.nan, 1.0], [np.inf, 1.0], [1.0], [1.0, 2.0, 3.0, 4.0], 3.0])
def test_bad_points(points: object) -> None:
    with pytest.raises(InvalidInput):
        certify(Scenario.of(1.0, 0.1), np.array(points))


@pytest.mark.parametrize(
    ("rate", "thrust"),
    [
        (-1.0, 0.1),
        (math.nan, 0.1),
        (math.inf, 0.1),
        (61.0, 0.1),
        (1.0, 0.0),
        (1.0, -0.1),
        (1.0, math.nan),
        (1.0, 98.1),
    ],
)
def test_bad_scenarios_name_the_field_and_what_came(rate: float, thrust: float) -> None:
    with pytest.raises(InvalidInput) as error:
        Scenario.of(rate, thrust)
    assert error.value.field in ("omega_t_deg_s", "max_acceleration")
    assert "required" in error.value.detail
    assert "received" in error.value.detail


@pytest.mark.parametrize(
    "arguments", [(1, 31, 150.0), (31, 0, 150.0), (31, 31, -1.0), (31, 31, math.nan), (4001, 4001, 150.0)]
)
def test_bad_grids(arguments: tuple[int, int, float]) -> None:
    with pytest.raises(InvalidInput):
        Grid(*arguments)


def test_grid_axes_are_the_documented_ones() -> None:
    x, y = Grid(31, 31, 150.0).axes(CorridorShape())
    half = 2.5 + 1.5 * (150.0 - 0.5)
    np.testing.assert_allclose(x, np.linspace(-half, half, 31))
    np.testing.assert_allclose(y, np.linspace(0.0, 150.0, 31))
    with pytest.raises(InvalidInput):
        Grid(31, 31, 0.5).axes(CorridorShape())

"""Properties that the reachable sets must have whatever the numbers."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from safestart.engines.base import Problem
from safestart.engines.load import engine
from safestart.model.scenario import Bools, Chaser, Floats, Grid, Rest, Scenario, SetKind, Target
from safestart.runtime.progress import Context

GRID = Grid(13, 11, 60.0)
rates = st.floats(0.0, 6.0)
thrusts = st.floats(0.005, 0.3)
steps = st.integers(2, 20)
rests = st.sampled_from(list(Rest))
kinds = st.sampled_from(list(SetKind))
sets = st.sampled_from(["exact", "backward", "forward"])
quick = settings(max_examples=40)


def mask(name: str, problem: Problem) -> Bools:
    found = engine(name).solve(problem, Context()).mask
    assert found is not None
    return found


def margin(name: str, problem: Problem) -> Floats:
    found = engine(name).solve(problem, Context()).margin
    assert found is not None
    return found


@quick
@given(sets, rates, thrusts, st.floats(1.0, 3.0), steps, rests, kinds)
def test_more_thrust_reaches_more(
    name: str, rate: float, thrust: float, factor: float, count: int, rest: Rest, kind: SetKind
) -> None:
    weak = Problem(Scenario.of(rate, thrust), GRID, 2.0 * count, rest=rest, kind=kind)
    strong = Problem(Scenario.of(rate, thrust * factor), GRID, 2.0 * count, rest=rest, kind=kind)
    assert not (mask(name, weak) & ~mask(name, strong)).any()


@quick
@given(rates, thrusts, st.integers(1, 15), st.integers(0, 10), rests)
def test_tube_grows_with_the_horizon_and_holds_the_fixed_set(
    rate: float, thrust: float, count: int, more: int, rest: Rest
) -> None:
    scenario = Scenario.of(rate, thrust)
    short = Problem(scenario, GRID, 2.0 * count, rest=rest, kind=SetKind.TUBE)
    longer = Problem(scenario, GRID, 2.0 * (count + more), rest=rest, kind=SetKind.TUBE)
    fixed = Problem(scenario, GRID, 2.0 * (count + more), rest=rest, kind=SetKind.FIXED)
    assert not (mask("exact", short) & ~mask("exact", longer)).any()
    assert not (mask("exact", fixed) & ~mask("exact", longer)).any()
    assert (margin("exact", longer) >= margin("exact", short) - 2e-3).all()
    assert (margin("exact", longer) >= margin("exact", fixed) - 2e-3).all()


@quick
@given(sets, st.floats(0.5, 3.0), thrusts, st.sampled_from([0.5, 2.0]), steps, rests)
def test_time_scaling(name: str, rate: float, thrust: float, factor: float, count: int, rest: Rest) -> None:
    """Clock k times faster: (k omega, k n, k^2 a, T / k) is the same geometry."""
    n = 5e-4
    slow = Problem(Scenario(Target(math.radians(rate), n), Chaser(thrust)), GRID, 2.0 * count, 2.0, rest)
    fast = Problem(
        Scenario(Target(math.radians(rate) * factor, n * factor), Chaser(thrust * factor**2)),
        GRID,
        2.0 * count / factor,
        2.0 / factor,
        rest,
    )
    one, two = engine(name).solve(slow, Context()), engine(name).solve(fast, Context())
    assert one.mask is not None
    assert two.mask is not None
    if one.margin is None or two.margin is None:
        assert np.array_equal(one.mask, two.mask)
        return
    inside = slow.inside()
    np.testing.assert_allclose(one.margin[inside], two.margin[inside], atol=1e-4)
    assert not ((one.mask != two.mask) & (np.abs(one.margin) > 1e-4)).any()


@quick
@given(sets, thrusts, steps, kinds)
def test_mirror_symmetry_without_tumble_and_orbit(
    name: str, thrust: float, count: int, kind: SetKind
) -> None:
    problem = Problem(Scenario.of(0.0, thrust, mean_motion=0.0), GRID, 2.0 * count, kind=kind)
    found = mask(name, problem)
    np.testing.assert_array_equal(found, found[:, ::-1])

"""What happens between the steps of the level-set solver, and beyond its box, is not overlooked."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from safestart.levelset import Ball, Boundary, Input, Kind, Lattice, Linear, March, Options, Scheme
from safestart.levelset.levels import Levels
from tests.unit.levelset.levelset_problems import DOUBLE, PUSH, box, solved

PLANE = Lattice.of([-10.0, -10.0], [10.0, 10.0], (81, 81))
SCHEMES = [Scheme.FIRST, Scheme.ENO2, Scheme.WENO5]


def crawling(speed: float) -> Linear:
    return Linear(np.zeros((2, 2)), (Input(np.eye(2), Ball(np.zeros(2), speed), "min"),))


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("kind", ["fixed", "tube"])
def test_an_obstacle_that_passes_between_two_steps(scheme: Scheme, kind: str) -> None:
    """It is over the vehicle at 5 s, far away at 0 and at 10 s: a single step said -6 for about +1."""
    x, y = PLANE.coordinates()

    def passing(time: float) -> Any:
        return 1.0 - np.hypot(x - 4.0 * (time - 5.0), y)

    values = np.hypot(x, y) - 6.0
    options = Options(scheme)
    march = March(PLANE, crawling(0.01), values, 10.0, Kind(kind), options)
    assert 0.75 / march.rate > 5.0, "steps are as long as the passage"
    field = solved(PLANE, crawling(0.01), values, 10.0, kind=kind, floor=passing, options=options)
    assert field.value_at(np.zeros(2)) == pytest.approx(1.0, abs=0.15)
    # On the track of the obstacle everywhere, beside it nowhere.
    assert (field.value_at(np.array([[-5.0, 0.0], [5.0, 0.0], [2.5, 0.0]])) > 0.8).all()
    assert field.value_at(np.array([0.0, 4.0])) == pytest.approx(-2.0, abs=0.2)


def test_a_target_that_passes_between_two_steps() -> None:
    x, y = PLANE.coordinates()

    def passing(time: float) -> Any:
        return np.hypot(x, y - 4.0 * (time - 5.0)) - 1.0

    values = passing(10.0)
    field = solved(
        PLANE, crawling(0.01), values, 10.0, kind="fixed", cap=passing, options=Options(Scheme.FIRST)
    )
    assert field.value_at(np.zeros(2)) == pytest.approx(-1.0, abs=0.15)
    assert field.value_at(np.array([4.0, 0.0])) == pytest.approx(3.0, abs=0.15)


def test_what_comes_first_counts() -> None:
    """Looked at backwards: the target at 4 s and the wall at 6 s are in time, the other way round they are not."""
    x, y = PLANE.coordinates()
    values = np.full(PLANE.shape, 5.0)

    def at(when: float, value: float, else_: float) -> Any:
        return lambda time: np.where(abs(time - when) <= 0.5, value, else_) + 0.0 * (x + y)

    for target, wall, expected in ((4.0, 6.0, -1.0), (6.0, 4.0, 2.0)):
        field = solved(
            PLANE,
            crawling(1e-3),
            values,
            10.0,
            kind="fixed",
            cap=at(target, -1.0, 9.0),
            floor=at(wall, 2.0, -9.0),
        )
        assert field.value_at(np.zeros(2)) == pytest.approx(expected)


def test_a_level_that_jumps_is_found_in_time() -> None:
    """A door that is shut for less than a tenth of a second."""
    x, y = PLANE.coordinates()
    seen = Levels(None, lambda time: np.where(4.0 < time < 4.08, 3.0, -3.0) + 0.0 * (x + y), 0.05)
    _, floor = seen.over(10.0, 0.0)
    assert floor is not None
    assert floor.min() == 3.0
    still = Levels(np.zeros((3, 3)), None, 0.05)
    assert not still.moving
    assert still.over(10.0, 0.0)[0] is still.at(3.0)[0]


@pytest.mark.parametrize("scheme", SCHEMES)
def test_motion_that_rests_at_the_horizon(scheme: Scheme) -> None:
    """x' = (T - t) y has no rate at T: it was solved in one step, at rest with ``first``."""
    lattice = Lattice.of([-12.0, -2.0], [12.0, 2.0], (121, 21))
    x, y = lattice.coordinates()
    horizon = 4.0
    motion = Linear(lambda time: np.array([[0.0, horizon - time], [0.0, 0.0]]))
    values = np.abs(x) - 1.0 + 0.0 * y
    options = Options(scheme)
    field = solved(lattice, motion, values, horizon, kind="fixed", options=options)
    states = np.array([[0.0, 1.0], [0.0, -1.0], [-4.0, 1.0], [2.0, 0.2]])
    moved = np.abs(states[:, 0] + states[:, 1] * horizon**2 / 2.0) - 1.0
    blur = {Scheme.FIRST: 0.3, Scheme.ENO2: 0.02, Scheme.WENO5: 0.02}[scheme]
    assert field.value_at(states) == pytest.approx(moved, abs=blur)
    assert field.value_at(np.array([0.0, 1.0])) > 6.0


def test_steps_of_a_varying_motion_are_stable_all_the_way() -> None:
    """Fast in the middle of the horizon, at rest at both ends."""
    lattice = Lattice.of([-6.0, -2.0], [6.0, 2.0], (61, 21))
    x, y = lattice.coordinates()
    motion = Linear(lambda time: math.exp(-((time - 5.0) ** 2)) * np.array([[0.0, 1.0], [0.0, 0.0]]))
    march = March(
        lattice, motion, np.abs(x) + 0.0 * y, 10.0, Kind.FIXED, Options(Scheme.FIRST), resolution=0.2
    )
    left, fastest = 10.0, 0.0
    while left > 0.0:
        before = march.time
        taken = march.step(left)
        for share in (0.0, 0.5, 1.0):
            rate = abs(motion.at(before - share * taken)[0, 1]) * 2.0 / lattice.spacing[0]
            fastest = max(fastest, rate * taken)
        left = 0.0 if taken >= left else left - taken
    assert 0.7 < fastest <= 0.75 * (1.0 + 1e-9)
    field = solved(lattice, motion, np.abs(x) + 0.0 * y, 10.0, kind="fixed", options=Options(Scheme.WENO5))
    assert field.value_at(np.array([0.0, 1.0])) == pytest.approx(math.sqrt(math.pi), abs=0.05)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_state_that_drifts_out_of_the_box_is_not_kept(scheme: Scheme) -> None:
    """x' = 1 leaves any box; behind the wall its value was repeated, and V was -1 for all."""
    lattice = Lattice.of([-2.0, -1.0], [2.0, 1.0], (41, 9))
    _x, _y = lattice.coordinates()
    motion = Linear(np.zeros((2, 2)), (), np.array([1.0, 0.0]))
    inside = -np.ones(lattice.shape)
    field = solved(lattice, motion, inside, 1.0, kind="always", options=Options(scheme))
    assert (field.value_at(np.array([[1.5, 0.0], [1.9, 0.5], [2.0, 0.0]])) > 0.0).all()
    assert (field.value_at(np.array([[-1.5, 0.0], [0.0, 0.5], [0.5, 0.0]])) < 0.0).all()
    # A disturbance that can push it out counts, a player who can hold it does not let it go.
    for aim, kept in (("max", False), ("min", True)):
        wall = Linear(np.zeros((2, 2)), (Input(np.eye(2), Ball(np.zeros(2), 1.0), aim),))
        field = solved(lattice, wall, inside, 0.5, kind="always", options=Options(scheme))
        assert bool(field.value_at(np.array([1.9, 0.0])) < 0.0) is kept
        assert field.value_at(np.zeros(2)) < 0.0


def test_staying_inside_a_set_that_reaches_the_wall() -> None:
    """A half-plane x <= 1 and |u| <= 1: what cannot turn before the box ends is not kept, the rest is as it was."""
    lattice = Lattice.of([-2.0, -3.0], [2.0, 3.0], (81, 121))
    x, v = lattice.coordinates()
    motion = Linear(DOUBLE, (Input(PUSH, box(1.0), "min"),))
    field = solved(lattice, motion, x - 1.0 + 0.0 * v, 4.0, kind="always", options=Options(Scheme.WENO3))
    leaving = np.array([[-1.0, -2.5], [-1.8, -1.5], [-2.0, -0.5]])
    assert (leaving[:, 0] - leaving[:, 1] ** 2 / 2.0 < -2.0).all()
    assert (field.value_at(leaving) > 0.0).all()
    kept = np.array([[-1.0, 0.0], [-0.5, -1.0], [0.0, 0.8]])
    assert (field.value_at(kept) < 0.0).all()


def test_a_periodic_axis_has_no_wall() -> None:
    lattice = Lattice.of([0.0, -1.0], [2.0 * math.pi, 1.0], (40, 9), [Boundary.PERIODIC, Boundary.EDGE])
    motion = Linear(np.zeros((2, 2)), (), np.array([1.0, 0.0]))
    field = solved(lattice, motion, -np.ones(lattice.shape), 5.0, kind="always")
    assert (field.values < 0.0).all()


def test_a_set_within_the_walls_keeps_its_values() -> None:
    lattice = Lattice.of([-2.0, -2.5], [2.0, 2.5], (41, 51))
    x, v = lattice.coordinates()
    motion = Linear(DOUBLE, (Input(PUSH, box(1.0), "min"),))
    values = np.maximum(np.abs(x), np.abs(v)) - 1.5 + 0.0 * x * v
    march = March(lattice, motion, values, 2.0, Kind.ALWAYS, Options(Scheme.WENO3))
    march.advance(2.0)
    field = solved(lattice, motion, values, 2.0, kind="always", options=Options(Scheme.WENO3))
    np.testing.assert_allclose(field.values, march.nodes(), rtol=0, atol=1e-12)

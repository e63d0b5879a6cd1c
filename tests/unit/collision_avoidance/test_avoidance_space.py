"""The avoid game in space: a value from two small grids that promises no more than the bounds allow."""

from dataclasses import replace

import numpy as np
import pytest

from safestart.collision_avoidance.bounds.certified import lower, upper
from safestart.collision_avoidance.game import Game
from safestart.collision_avoidance.space import SpaceTube
from safestart.collision_avoidance.tube import Answer, solve_tube
from safestart.collision_avoidance.tube_settings import TubeSettings
from safestart.constraints.thrust import InputSet
from safestart.errors import InvalidInput

GAME = Game(0.0011, InputSet("ball", (0.1,)), InputSet("ball", (0.05,)), 100.0)
T = 40.0
ENDS = np.array([400.0, 400.0, 400.0, 5.0, 5.0, 5.0])
STATES = np.random.default_rng(4).uniform(-0.8, 0.8, (1500, 6)) * ENDS


@pytest.fixture(scope="module")
def tube() -> SpaceTube:
    settings = TubeSettings(shape=(21, 9), half=(400.0, 5.0), kept=3)
    finer = replace(settings, shape=(84, 36))
    plane = solve_tube(GAME.restricted(0, 2), T, settings)
    return SpaceTube(GAME, plane, solve_tube(GAME.restricted(2, 3), T, finer))


def test_the_larger_of_two_values_is_no_promise_too_much(tube: SpaceTube) -> None:
    value, above = tube.value(STATES), upper(GAME, STATES, T)
    assert (value <= above + tube.grid_error_m).all()
    assert ((value > 0.0) & (above > 0.0)).mean() > 0.5
    plane = tube.plane.value(STATES[:, [0, 1, 3, 4]])
    assert (value >= plane).all()
    assert (value > plane + 10.0).any()


def test_answers_in_space(tube: SpaceTube) -> None:
    """Proofs first; what is called safe on the grid's word is not refuted by the bounds."""
    answers = tube.answer(STATES)
    proved = np.abs(answers) == 2
    assert proved.mean() > 0.99
    assert ((answers == Answer.PROVED_SAFE) == (lower(GAME, STATES, T, goal_m=1e-6) > 0.0)).all()
    assert not (answers == Answer.UNSAFE).any()


def test_the_gradient_is_of_the_better_way_out(tube: SpaceTube) -> None:
    over = np.array([0.0, 0.0, 250.0, 1.0, 0.0, 0.0])
    found = tube.gradient(over)
    np.testing.assert_allclose(found[[0, 1, 3, 4]], 0.0)
    assert found[2] == pytest.approx(1.0, abs=0.05)
    assert tube.covers(over)
    assert not tube.covers(2.0 * over)
    with pytest.raises(InvalidInput):
        tube.value(over[:4])

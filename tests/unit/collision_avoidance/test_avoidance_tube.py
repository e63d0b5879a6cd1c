"""The avoid game's tube: joined with the certified bounds, read between nodes, refused outside."""

import numpy as np
import pytest

from safestart.collision_avoidance.bounds.certified import lower, upper
from safestart.collision_avoidance.bounds.directions import covering
from safestart.collision_avoidance.game import Game, Players
from safestart.collision_avoidance.tube import Answer, Tube, solve_tube
from safestart.collision_avoidance.tube_settings import TubeSettings
from safestart.constraints.thrust import InputSet
from safestart.errors import InvalidInput
from safestart.levelset import optimal_inputs

pytestmark = pytest.mark.slow

GAME = Game(0.0011, InputSet("box", (0.1, 0.1)), InputSet("box", (0.05, 0.05)), 100.0)
HALF, T = (400.0, 5.0), 40.0
RNG = np.random.default_rng(8)


def small(**given: object) -> TubeSettings:
    return TubeSettings(**{"shape": (21, 9), "half": HALF, "kept": 3, **given})  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def tube() -> Tube:
    return solve_tube(GAME, T, small())


def test_nothing_proved_is_contradicted_after_joining(tube: Tube) -> None:
    """The grid alone calls lost states safe; the joined values lie between the bounds, computed anew on every node."""
    check = tube.check
    assert check is not None
    assert check.unsafe_called_safe > 0
    assert check.unsafe_called_safe_joined == check.safe_called_unsafe_joined == 0
    assert check.proved_unsafe + check.proved_safe + check.undecided == check.nodes == 21**2 * 9**2
    assert check.undecided < 0.001 * check.nodes
    states = np.stack(np.meshgrid(*tube.lattice.axes, indexing="ij"), axis=-1)
    for k, time in enumerate(tube.times):
        assert (tube.values[k] <= upper(GAME, states, float(time))).all()
    assert (tube.values[-1] >= lower(GAME, states, T, goal_m=1e-6, effort=0)).all()
    assert (np.diff(tube.values, axis=0) <= 1e-3).all()


def test_answers_anywhere_are_proved(tube: Tube) -> None:
    """Off the nodes too: of random states none is undecided by much, and proofs agree with the bounds."""
    states = RNG.uniform(-1.0, 1.0, (2000, 4)) * np.array([400.0, 400.0, 5.0, 5.0])
    answers = tube.answer(states)
    above, below = upper(GAME, states, T), lower(GAME, states, T, goal_m=1e-6)
    assert ((answers == Answer.PROVED_UNSAFE) == (above <= 0.0)).all()
    assert ((answers == Answer.PROVED_SAFE) == (below > 0.0)).all()
    assert (np.abs(answers) == 2).mean() > 0.999


def test_the_stated_error_holds_between_nodes(tube: Tube) -> None:
    """Values read anywhere near the boundary lie within the stated error of the bounds."""
    states = RNG.uniform(-1.0, 1.0, (3000, 4)) * np.array([400.0, 400.0, 5.0, 5.0])
    value, above = tube.value(states), upper(GAME, states, T)
    near = np.abs(above) < 20.0
    below = lower(GAME, states[near], T, effort=0)
    assert 0.0 < tube.grid_error_m < 60.0
    # The middles of cells are where a bend between nodes shows most, not a bound for every state: hence 1.2.
    assert (value[near] - above[near]).max() < 1.2 * tube.grid_error_m
    assert (below - value[near]).max() < 1.2 * tube.grid_error_m


def test_reading_between_times_and_states(tube: Tube) -> None:
    nodes = [axis[3] for axis in tube.lattice.axes]
    at = np.array(nodes)
    assert tube.value(at) == pytest.approx(tube.values[-1, 3, 3, 3, 3])
    assert tube.value(at, 0.0) == pytest.approx(np.hypot(*at[:2]) - 100.0)
    between = tube.value(at, 30.0)
    assert between == pytest.approx(0.5 * (tube.values[1, 3, 3, 3, 3] + tube.values[2, 3, 3, 3, 3]))
    away = np.array([250.0, 0.0, 1.0, 0.0])
    np.testing.assert_allclose(tube.gradient(away)[:2], [1.0, 0.0], atol=1e-6)
    assert not tube.covers(np.array([401.0, 0.0, 0.0, 0.0]))
    assert tube.covers(away)
    axes, values = tube.slice((0.0, 0.0))
    assert values.shape == (21, 21)
    assert len(axes) == 2
    for bad in (lambda: tube.value(np.array([401.0, 0.0, 0.0, 0.0])), lambda: tube.value(at, T + 1.0)):
        with pytest.raises(InvalidInput):
            bad()


def test_the_papers_equation_makes_player_one_seek_the_disk(tube: Tube) -> None:
    """inf over u, sup over d: states that Player 1 can save are called unsafe. Its set is one of plain reach.

    That has a closed form: the least distance at a time is the largest over directions s of -(s . q) - sigma(s).
    """
    paper = solve_tube(GAME, T, small(players=Players.PAPER))
    assert paper.check is not None
    assert paper.check.safe_called_unsafe > 500
    away = np.array([250.0, 0.0, -2.0, 0.0])
    assert paper.value(away) < tube.value(away) - 50.0
    assert tube.motion.inputs[0].aim == "max"
    assert paper.motion.inputs[0].aim == "min"
    states = np.random.default_rng(2).uniform(-0.7, 0.7, (500, 4)) * np.array([400.0, 400.0, 5.0, 5.0])
    directions, _ = covering(2)
    exact = np.full(500, np.inf)
    for time in np.linspace(0.0, T, 81):
        # Without orbital terms in sigma: they change it by less than a centimetre in 40 s.
        sigma = 0.5 * time**2 * 0.05 * np.abs(directions).sum(axis=1)
        q = states @ GAME.transition(time)[:2].T
        exact = np.minimum(exact, (-(q @ directions.T) - sigma).max(axis=1))
    error = paper.value(states) - (np.maximum(exact, 0.0) - 100.0)
    # Inside the disk the target's cone is cut off between nodes; cells are 40 m wide.
    assert np.abs(error[exact > 60.0]).max() < 20.0
    assert np.abs(error[exact > 60.0]).mean() < 4.0


def test_fuel_has_its_price() -> None:
    """A priced value is no more than the free one, and coasting becomes optimal where thrust gains little."""
    given = {"accuracy": "low", "join": False, "together": False}
    free, priced = solve_tube(GAME, T, small(**given)), solve_tube(GAME, T, small(**given, fuel_price=20.0))
    # The first-order scheme is monotone: what holds of the game holds of the grid, to the last bit.
    assert (priced.raw <= free.raw).all()
    assert (priced.raw < free.raw - 10.0).any()
    grazing = np.array([200.0, 100.0, -5.0, 0.0])
    (u, _), slow = free.motion.inputs, priced.motion.inputs[0]
    assert (u.price, slow.price) == (0.0, 20.0)
    chosen = optimal_inputs(priced.motion, priced.gradient(grazing), grazing)[0]
    assert (chosen == 0.0).any()
    assert (np.abs(optimal_inputs(free.motion, free.gradient(grazing), grazing)[0]) == 0.1).all()


def test_bad_settings_are_refused() -> None:
    for wrong in (
        {"accuracy": "best"},
        {"kept": 1},
        {"fuel_price": -1.0},
        {"half": (0.0, 1.0)},
        {"shape": (901, 301)},
        {"players": "all"},
    ):
        with pytest.raises((InvalidInput, ValueError)):
            solve_tube(GAME, T, small(**wrong))

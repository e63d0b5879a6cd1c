"""A certified margin rests on inputs that the player has: decided in rational numbers, whatever underflows."""

import math
from fractions import Fraction

import numpy as np
import pytest

from safestart.collision_avoidance.bounds.admissible import fits, inner_radii, realisable
from safestart.collision_avoidance.bounds.certified import lower, witness
from safestart.collision_avoidance.game import Game
from safestart.collision_avoidance.inputs import InputSet
from safestart.levelset import Ball, Box, Input, Linear
from safestart.levelset.field import optimal_inputs
from safestart.model.scenario import Floats
from safestart.model.unit import unit

W = 1.1e-3


def exactly(game: Game, inputs: Floats) -> bool:
    """|w| + (the most that d takes) <= the control's radius, for disks and balls against the same shape."""
    (own,), (other,) = game.control.bound, game.disturbance.bound
    left = Fraction(own) - Fraction(other)
    rows = {tuple(row) for row in inputs.reshape(-1, game.channels).tolist()}
    return all(sum((Fraction(e) ** 2 for e in row), Fraction(0)) <= left**2 for row in rows)


@pytest.mark.slow
@pytest.mark.parametrize(("shape", "channels"), [("disk", 2), ("ball", 3)])
@pytest.mark.parametrize("horizon", [600.0, 3600.0])
def test_witnesses_are_realisable_to_the_last_bit(shape: str, channels: int, horizon: float) -> None:
    """They were up to 2.5 % outside: squares of short slopes had underflowed, and with them the length."""
    rng = np.random.default_rng(channels)
    for strength, share in ((0.1, 0.5), (1e-3, 0.9), (3e-5, 0.0), (0.03, 1.0)):
        sets = InputSet(shape, (strength,)), InputSet(shape, (share * strength,))
        game = Game(W, *sets, 100.0)
        p = rng.uniform(-400.0, 400.0, (12, channels))
        v = -p / horizon * rng.uniform(0.0, 2.0, (12, 1)) + rng.uniform(-0.2, 0.2, (12, channels))
        found = witness(game, np.concatenate([p, v], axis=1), horizon, effort=12)
        assert exactly(game, found.inputs)
        assert np.isfinite(found.margin_m).all()
        assert (found.margin_m == lower(game, np.concatenate([p, v], axis=1), horizon, effort=12)).all()


@pytest.mark.parametrize("size", [1e-300, 1e-162, 1e-155, 1e-141, 1e-100, 1.0, 1e100, 1e155, 1e300])
@pytest.mark.parametrize("channels", [2, 3])
def test_short_and_long_directions_have_length_one(size: float, channels: int) -> None:
    directions = size * np.random.default_rng(1).uniform(-1.0, 1.0, (200, channels))
    lengths = np.linalg.norm(unit(directions), axis=-1)
    assert np.abs(lengths - 1.0).max() < 1e-15
    shape = {2: "disk", 3: "ball"}[channels]
    pushes = InputSet(shape, (0.1,)).extreme(directions)
    assert np.linalg.norm(pushes, axis=-1).max() <= 0.1 * (1.0 + 1e-15)
    if size <= 1e100:
        ball = Input(np.eye(channels), Ball(np.zeros(channels), 0.1), "max")
        (best,) = optimal_inputs(Linear(np.zeros((channels, channels)), (ball,)), directions, directions)
        assert np.linalg.norm(best, axis=-1).max() <= 0.1 * (1.0 + 1e-15)


def test_usual_directions_keep_their_bits() -> None:
    directions = np.random.default_rng(2).uniform(-5.0, 5.0, (500, 3))
    directions[7], directions[8] = 0.0, 1e-200
    plain = directions / np.maximum(np.linalg.norm(directions, axis=-1, keepdims=True), 1e-300)
    kept = np.arange(500) != 8
    assert (unit(directions)[kept] == plain[kept]).all()
    assert (unit(directions)[7] == 0.0).all()


def test_what_fits_is_decided_exactly() -> None:
    nine, sixteen = Fraction(9), Fraction(16)
    assert fits(nine, 7.0, (4.0,))
    assert fits(nine, 8.0, (3.0, 4.0))
    assert not fits(nine + Fraction(1, 10**40), 8.0, (3.0, 4.0))
    assert fits(sixteen, 4.0, ())
    assert not fits(Fraction(0), 4.0, (math.nextafter(4.0, 5.0),))
    assert not fits(Fraction(4), 1.0, (2.0,)), "a negative difference has a square, too"


@pytest.mark.parametrize(
    ("own", "other"),
    [
        (InputSet("disk", (0.1,)), InputSet("box", (0.03, 0.04))),
        (InputSet("ball", (0.1,)), InputSet("cylinder", (0.07, 0.01))),
        (InputSet("cylinder", (0.2, 0.1)), InputSet("box", (0.01, 0.02, 0.1))),
        (InputSet("box", (0.1, 0.3)), InputSet("disk", (0.1,))),
        (InputSet("box", (0.1, 0.1)), InputSet("box", (0.1, 0.1 - 1e-17))),
    ],
)
def test_inner_radii_fit_and_are_nearly_all_there_is(own: InputSet, other: InputSet) -> None:
    game = Game(W, own, other, 10.0)
    radii, left = inner_radii(game), game.realisable
    assert radii is not None
    assert left is not None
    for radius, part in zip(radii, left.parts, strict=True):
        assert part.radius * (1.0 - 1e-12) <= radius <= part.radius
    m = game.channels
    rng = np.random.default_rng(4)
    for factor, inside in ((1.0 - 1e-12, True), (1.0 + 1e-9, all(radius == 0.0 for radius in radii))):
        sums = factor * left.extreme(rng.standard_normal((40, m)))
        assert realisable(game, sums[:, None]).all() == inside
    found = witness(game, np.array([[50.0] * m + [-0.3] * m]), 60.0, effort=5)
    assert realisable(game, found.inputs).all()


def test_a_disturbance_stronger_by_a_bit_leaves_nothing() -> None:
    """Within the rounding that `realisable` sets forgive, no control takes all of it back: nothing is claimed."""
    game = Game(W, InputSet("disk", (0.1,)), InputSet("disk", (math.nextafter(0.1, 1.0),)), 10.0)
    assert game.realisable is not None
    assert inner_radii(game) is None
    start = np.array([[900.0, 0.0, 0.0, 0.0]])
    assert np.isneginf(lower(game, start, 10.0)).all()
    assert np.isneginf(witness(game, start, 10.0).margin_m).all()
    equal = Game(W, InputSet("disk", (0.1,)), InputSet("disk", (0.1,)), 10.0)
    assert (lower(equal, start, 10.0) > 0.0).all()


def test_boxes_are_left_alone() -> None:
    motion = Linear(np.zeros((2, 2)), (Input(np.eye(2), Box(np.full(2, -0.1), np.full(2, 0.1)), "max"),))
    (best,) = optimal_inputs(motion, np.array([[1e-170, -1e-170]]), np.zeros((1, 2)))
    assert best.tolist() == [[0.1, -0.1]]

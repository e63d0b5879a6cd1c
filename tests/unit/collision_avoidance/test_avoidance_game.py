"""The avoid game: its model, the net inputs, certified bounds against closed forms and independent flights."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from safestart.collision_avoidance.bounds.certified import lower, unavoidable, upper, witness
from safestart.collision_avoidance.bounds.directions import covering
from safestart.collision_avoidance.game import Game
from safestart.collision_avoidance.inputs import held_down, left_over
from safestart.constraints.thrust import InputSet
from safestart.errors import InvalidInput

W = 0.0011
PAPER = Game(W, InputSet("box", (0.1, 0.1)), InputSet("box", (0.05, 0.05)), 100.0)
SPACE = Game(W, InputSet("ball", (0.1,)), InputSet("ball", (0.05,)), 100.0)
RNG = np.random.default_rng(3)


def near_states(game: Game, count: int) -> np.ndarray:
    """States about the keep-out disk, many of them heading for it."""
    m, d = game.channels, game.keep_out_m
    p = RNG.uniform(-2.5 * d, 2.5 * d, (count, m))
    v = -p / 40.0 * RNG.uniform(0.0, 1.5, (count, 1)) + RNG.uniform(-1.0, 1.0, (count, m))
    return np.concatenate([p, v], axis=1)


def flown(game: Game, start: np.ndarray, pieces: np.ndarray, step: float) -> float:
    """Least distance of a flight under piecewise constant sums, by an adaptive integrator with dense output."""
    m, least, a = game.channels, np.inf, paper_matrix(game)
    x = start
    for w in pieces:
        push = np.concatenate([np.zeros(m), w])

        def rate(t: float, s: np.ndarray, push: np.ndarray = push) -> np.ndarray:
            return np.asarray(a @ s + push)

        run = solve_ivp(rate, (0.0, step), x, rtol=1e-11, atol=1e-9, dense_output=True)
        track = run.sol(np.linspace(0.0, step, 20))
        least = min(least, np.linalg.norm(track[:m], axis=0).min())
        x = run.y[:, -1]
    return float(least)


def paper_matrix(game: Game) -> np.ndarray:
    """Eq. (5) written out; in space with z'' = -w^2 z."""
    m = game.channels
    a = np.zeros((2 * m, 2 * m))
    a[:m, m:] = np.eye(m)
    if m > 1:
        a[m, m + 1], a[m + 1, m], a[m + 1, 1] = -2.0 * W, 2.0 * W, 3.0 * W * W
    if m != 2:
        a[2 * m - 1, m - 1] = -W * W
    return a


@pytest.mark.parametrize("game", [PAPER, SPACE, SPACE.restricted(2, 3)])
def test_the_matrix_is_the_papers(game: Game) -> None:
    np.testing.assert_allclose(game.matrix(), paper_matrix(game), atol=1e-18)
    half = game.transition(20.0)
    np.testing.assert_allclose(half @ half, game.transition(40.0), rtol=1e-12, atol=1e-12)


def test_net_inputs_of_every_pair_of_shapes() -> None:
    """Sampled: every w of the one set plus every -d lies in U; the answer -k u lies in D and leaves u - k u in W."""
    sets = [
        InputSet("box", (0.1, 0.12, 0.3)),
        InputSet("ball", (0.11,)),
        InputSet("cylinder", (0.13, 0.1)),
    ]
    others = [
        InputSet("box", (0.02, 0.05, 0.03)),
        InputSet("ball", (0.04,)),
        InputSet("cylinder", (0.03, 0.06)),
    ]
    s = RNG.standard_normal((60, 3))
    for own in sets:
        for other in others:
            kept, held = left_over(own, other), held_down(own, other)
            assert kept is not None
            sums = kept.extreme(s)[:, None] - other.extreme(s)[None]
            assert (sums.reshape(-1, 3) @ s.T <= own.support(s) * (1 + 1e-12)).all()
            share = 1.0 - np.repeat(
                np.array(held.bound) / np.array(own.bound), [p.end - p.begin for p in own.parts]
            )
            assert (share >= 0.0).all()
            assert ((own.extreme(s) * share) @ s.T <= other.support(s) * (1 + 1e-12)).all()
            if own.shape == other.shape:
                np.testing.assert_allclose(kept.bound, held.bound)
    assert left_over(InputSet("disk", (0.1,)), InputSet("box", (0.08, 0.08))) is None


def test_bad_games_are_refused() -> None:
    for wrong in (
        lambda: InputSet("disk", (0.1, 0.1)),
        lambda: InputSet("round", (0.1,)),
        lambda: InputSet("box", (0.1, -0.1)),
        lambda: Game(W, InputSet("disk", (0.1,)), InputSet("ball", (0.1,)), 10.0),
        lambda: Game(W, InputSet("disk", (0.1,)), InputSet("disk", (0.1,)), 0.0),
        lambda: upper(PAPER, np.zeros(3), 10.0),
        lambda: upper(PAPER, np.full(4, np.nan), 10.0),
        lambda: lower(PAPER, np.zeros(4), -1.0),
        lambda: PAPER.restricted(0, 2),
    ):
        with pytest.raises(InvalidInput):
            wrong()


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_directions_cover(dimension: int) -> None:
    directions, widen = covering(dimension)
    v = RNG.standard_normal((20_000, dimension))
    assert (np.linalg.norm(v, axis=1) <= widen * (v @ directions.T).max(axis=1) * (1 + 1e-12)).all()
    assert widen < 1.01


def test_double_integrator_on_a_line_has_a_closed_form() -> None:
    """Without gravity the least z > 0 under full thrust outwards is z - v^2 / (2 a), or |z| = 0: both bounds hit it."""
    game = Game(0.0, InputSet("box", (0.1,)), InputSet("box", (0.04,)), 10.0)
    a, horizon = 0.06, 50.0
    z = RNG.uniform(20.0, 60.0, 300)
    v = -RNG.uniform(0.0, 1.0, 300) * np.sqrt(2.0 * a * z) * 1.05
    stop = np.minimum(-v / a, horizon)
    exact = np.maximum(z + v * stop + 0.5 * a * stop**2, 0.0) - 10.0
    states = np.stack([z, v], axis=1)
    above, below = upper(game, states, horizon), lower(game, states, horizon)
    assert (above >= exact - 1e-9).all()
    assert (above <= exact + 0.01).all()
    assert (below <= exact + 1e-9).all()
    assert (below >= exact - 0.02).all()


@pytest.mark.parametrize(
    "game",
    [
        PAPER,
        Game(W, InputSet("disk", (0.1,)), InputSet("disk", (0.05,)), 100.0),
        Game(W, InputSet("box", (0.1, 0.1)), InputSet("disk", (0.05,)), 100.0),
        SPACE,
        Game(W, InputSet("box", (0.1, 0.1, 0.1)), InputSet("cylinder", (0.05, 0.02)), 100.0),
    ],
)
def test_bounds_are_never_crossed_and_witnesses_fly(game: Game) -> None:
    """Random sums cannot save a lost state; every witness keeps its margin in an independent integrator."""
    horizon, m = 40.0, game.channels
    states = near_states(game, 300)
    above, below = upper(game, states, horizon), lower(game, states, horizon, effort=10)
    assert (below <= above).all()
    lost = states[above <= 0.0][:40]
    assert len(lost) > 10
    assert (unavoidable(game, lost, horizon)).all()
    pieces = game.enforceable.extreme(RNG.standard_normal((60, 80, m)))
    step, push, moved = game.transition(0.5), game.held_input(0.5), np.tile(lost, (60, 1, 1))
    least = np.linalg.norm(moved[..., :m], axis=-1)
    for k in range(80):
        moved = moved @ step.T + pieces[:, None, k] @ push.T
        least = np.minimum(least, np.linalg.norm(moved[..., :m], axis=-1))
    assert (least - game.keep_out_m <= above[above <= 0.0][:40] + 0.05).all()
    saved = states[(below > 0.0) & (above < 60.0)][:6]
    assert len(saved) > 2
    found = witness(game, saved, horizon, effort=10)
    assert (lower(game, saved, horizon, goal_m=1e-6) > 0.0).all()
    for k, start in enumerate(saved):
        assert game.realisable is not None
        s = RNG.standard_normal((200, m))
        assert (found.inputs[k] @ s.T <= game.realisable.support(s) + 1e-12).all()
        distance = flown(game, start, found.inputs[k], found.step_s)
        assert distance - game.keep_out_m >= found.margin_m[k]
        assert distance - game.keep_out_m <= found.margin_m[k] + 0.3


def test_a_stronger_disturbance_leaves_nothing_to_certify() -> None:
    game = Game(W, InputSet("disk", (0.05,)), InputSet("disk", (0.06,)), 100.0)
    assert game.realisable is None
    assert not lower(game, np.array([900.0, 0.0, 0.0, 0.0]), 10.0) > 0.0
    with pytest.raises(InvalidInput):
        witness(game, np.array([900.0, 0.0, 0.0, 0.0]), 10.0)


def test_braking_lowers_the_orbit_and_brings_the_chaser_forward() -> None:
    """The paper's Mode 3 (tangential braking keeps the altitude, adds distance behind) holds for minutes only."""
    braked = np.array([-1000.0, 0.0, -1.0, 0.0])
    early, late = (PAPER.transition(t) @ braked for t in (600.0, 3000.0))
    assert early[0] < -1000.0
    assert early[1] < -300.0
    assert late[0] > 0.0
    # Turning point of 4 sin(w t) / w - 3 t: back where it braked after 4 sin(x) = 3 x, x = 1.2757.
    back = PAPER.transition(1.2756981 / W) @ braked
    assert back[0] == pytest.approx(-1000.0, abs=1e-3)

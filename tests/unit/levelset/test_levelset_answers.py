"""What the level-set solver finds, against closed forms: orders, games, viability, obstacles, fuel, foreign models."""

from typing import Any

import numpy as np
import pytest

from safestart.levelset import Ball, Flux, Input, Kind, Lattice, Linear, Options, Scheme
from safestart.levelset.adapter import Tabulated
from tests.unit.levelset.levelset_problems import DOUBLE, PUSH, box, solved


def smooth_error(scheme: Scheme, flux: Flux, nodes: int) -> float:
    """Double integrator, |u| <= 1 minimises l = x + 0.3 sin(2 x) at T = 0.5: V = l(x + v T - T^2 / 2), as l rises."""
    lattice = Lattice.of([-6.0, -2.0], [6.0, 2.0], (3 * nodes, nodes))
    x, v = lattice.coordinates()
    horizon = 0.5

    def level(at: np.ndarray) -> np.ndarray:
        return at + 0.3 * np.sin(2.0 * at)

    motion = Linear(DOUBLE, (Input(PUSH, box(1.0), "min"),))
    # Steps short enough that the error in time, of third order, stays below that of WENO5.
    courant = 0.75 * (20.0 / nodes) ** (2.0 / 3.0) if scheme is Scheme.WENO5 else 0.75
    options = Options(scheme, flux=flux, courant=courant)
    found = solved(lattice, motion, level(x + 0.0 * v), horizon, kind=Kind.FIXED, options=options).values
    exact = level(x + v * horizon - 0.5 * horizon**2)
    inner = (np.abs(x) < 2.5) & (np.abs(v) < 0.5)
    return float(np.abs(found - exact)[inner].max())


@pytest.mark.parametrize("flux", list(Flux))
@pytest.mark.parametrize(
    ("scheme", "order"),
    [(Scheme.FIRST, 0.9), (Scheme.ENO2, 1.7), (Scheme.WENO3, 1.7), (Scheme.ENO3, 2.6), (Scheme.WENO5, 4.0)],
)
def test_convergence_order(scheme: Scheme, order: float, flux: Flux) -> None:
    """Against a smooth closed form; WENO3 falls to second order where the slope has an extremum."""
    errors = [smooth_error(scheme, flux, nodes) for nodes in (40, 80)]
    found = np.log2(errors[0] / errors[1])
    assert found >= order, (found, errors)


def test_avoid_game_of_a_double_integrator() -> None:
    """|u| <= 1 flees from |x| <= 1, |d| <= 0.4 chases: with a net thrust of 0.6, x + v t + 0.3 t^2 is the farthest."""
    lattice = Lattice.of([-4.0, -3.0], [4.0, 3.0], (121, 91))
    x, v = lattice.coordinates()
    players = (Input(PUSH, box(1.0), "max"), Input(PUSH, box(0.4), "min"))
    values = np.abs(x) - 1.0 + 0.0 * v
    field = solved(lattice, Linear(DOUBLE, players), values, 1.5, options=Options(Scheme.WENO5))
    moments = np.linspace(0.0, 1.5, 151)[:, None, None]
    # From the right only fleeing to the right helps before the target is reached; so too from the left, mirrored.
    right = (x + v * moments + 0.3 * moments**2).min(axis=0) - 1.0
    left = (-x - v * moments + 0.3 * moments**2).min(axis=0) - 1.0
    exact = np.where(x > 0, right, left)
    outside = np.abs(x) > 1.0
    clear = np.broadcast_to(outside, exact.shape) & (np.abs(exact) > 0.08) & (np.abs(v) < 2.0)
    assert ((field.values <= 0.0) == (exact <= 0.0))[clear].all()
    assert clear.sum() > 4000


def test_staying_in_a_set() -> None:
    """Viability: |x| <= 1 can be kept for ever with |u| <= 1 where x + v |v| / 2 is in [-1, 1]."""
    lattice = Lattice.of([-2.0, -2.5], [2.0, 2.5], (81, 101))
    x, v = lattice.coordinates()
    motion = Linear(DOUBLE, (Input(PUSH, box(1.0), "min"),))
    field = solved(
        lattice, motion, np.abs(x) - 1.0 + 0.0 * v, 4.0, kind="always", options=Options(Scheme.WENO3)
    )
    stop = x + v * np.abs(v) / 2.0
    clear = (np.abs(np.abs(stop) - 1.0) > 0.12) & (np.abs(np.abs(x) - 1.0) > 0.1)
    expected = (np.abs(stop) <= 1.0) & (np.abs(x) <= 1.0)
    assert ((field.values <= 0.0) == expected)[clear].all()


def test_moving_target_and_obstacle() -> None:
    """Speed 1 in the plane, a disc of radius 0.5 that moves at 0.5: least over t of max(|p - c(t)| - t, 0) - 0.5."""
    lattice = Lattice.of([-4.0, -4.0], [4.0, 4.0], (81, 81))
    x, y = lattice.coordinates()
    motion = Linear(np.zeros((2, 2)), (Input(np.eye(2), Ball(np.zeros(2), 1.0), "min"),))

    def disc(time: float) -> np.ndarray:
        return np.hypot(x - 0.5 * time, y) - 0.5

    field = solved(lattice, motion, disc(2.0), 2.0, kind="fixed", cap=disc, options=Options(Scheme.WENO5))
    moments = np.linspace(0.0, 2.0, 201)[:, None, None]
    exact = (np.maximum(np.hypot(x - 0.5 * moments, y) - moments, 0.0) - 0.5).min(axis=0)
    assert np.abs(field.values - exact)[exact > -0.2].max() < 0.06
    # A wall with a gap beside it: behind it the way is longer, on the wall itself nothing helps.
    wall = np.where((np.abs(x + 1.5) <= 0.25) & (np.abs(y) <= 2.0), 1.0, -1.0)
    walled = solved(
        lattice, motion, disc(0.0), 4.0, cap=disc(0.0), floor=wall, options=Options(Scheme.FIRST, courant=0.5)
    )
    assert (walled.values >= wall - 1e-12).all()
    free = solved(lattice, motion, disc(0.0), 4.0, options=Options(Scheme.FIRST))
    behind, beside = np.array([-2.5, 0.0]), np.array([2.5, 0.0])
    assert walled.value_at(behind) > free.value_at(behind) + 0.1
    assert walled.value_at(beside) == pytest.approx(free.value_at(beside), abs=0.02)


def test_fuel_has_a_price() -> None:
    """Rest is best where the slope does not pay: l = 0.3 |x| with price 0.4 stays, with price 0.1 pays 0.2 a second."""
    lattice = Lattice.of([-3.0, -1.0], [3.0, 1.0], (61, 5))
    x, y = lattice.coordinates()
    values = 0.3 * np.abs(x) + 0.0 * y
    for price, gain in ((0.4, 0.0), (0.1, 0.2)):
        motion = Linear(np.zeros((2, 2)), (Input(np.eye(2), Ball(np.zeros(2), 1.0), "min", price),))
        field = solved(lattice, motion, values, 1.0, kind="fixed", options=Options(Scheme.WENO5))
        assert field.value_at(np.array([2.0, 0.0])) == pytest.approx(0.6 - gain, abs=5e-3)


class Plain:
    """A model in hj-reachability's form, of NumPy only."""

    control_mode, disturbance_mode = "min", "max"

    class _Set:
        lo, hi = np.array([-1.0]), np.array([1.0])

    control_space, disturbance_space = _Set(), _Set()

    def open_loop_dynamics(self, state: Any, time: Any) -> Any:
        return np.array([state[1], -0.1 * state[0]])

    def control_jacobian(self, state: Any, time: Any) -> Any:
        return np.array([[0.0], [1.0]])

    def disturbance_jacobian(self, state: Any, time: Any) -> Any:
        return np.array([[0.0], [0.3]])


class Clocked(Plain):
    def open_loop_dynamics(self, state: Any, time: Any) -> Any:
        return np.array([state[1], np.sin(time)])


def test_a_numpy_model_of_the_other_library_s_form() -> None:
    lattice = Lattice.of([-2.0, -2.0], [2.0, 2.0], (15, 17))
    x, v = lattice.coordinates()
    values = np.hypot(x, v) - 0.5
    native = Linear(
        np.array([[0.0, 1.0], [-0.1, 0.0]]),
        (Input(PUSH, box(1.0), "min"), Input(0.3 * PUSH, box(1.0), "max")),
    )
    ours, theirs = (solved(lattice, model, values, 0.8) for model in (native, Plain()))
    np.testing.assert_allclose(ours.values, theirs.values, rtol=0, atol=1e-12)
    assert not Tabulated.of(Plain(), lattice).varies
    assert Tabulated.of(Clocked(), lattice).varies
    moving = Linear(lambda time: np.array([[0.0, 1.0], [np.sin(time), 0.0]]))
    assert moving.varies

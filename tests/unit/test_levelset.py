"""The fused level-set solver: kernels against their twin, closed forms, orders, failure, reading between nodes."""

import tracemalloc
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from safestart.errors import Cancelled, InvalidInput
from safestart.levelset import (
    Ball,
    Boundary,
    Box,
    Flux,
    Input,
    Kind,
    Lattice,
    Linear,
    March,
    Options,
    Scheme,
    ValueField,
    optimal_inputs,
    solve,
)
from safestart.levelset.adapter import Tabulated
from safestart.levelset.dynamics import Rates
from safestart.progress import Context
from tests.unit.levelset_twin import euler

RNG = np.random.default_rng(5)
SHAPES = {2: (9, 12), 3: (8, 13, 7), 4: (7, 9, 6, 8), 5: (5, 6, 5, 7, 5), 6: (5, 5, 6, 5, 5, 5)}


def wavy(lattice: Lattice) -> np.ndarray:
    """Something with slopes of either sign, kinks and no symmetry."""
    x = lattice.coordinates()
    smooth = sum(np.sin(1.3 * (i + 1) * c + i) for i, c in enumerate(x))
    return np.asarray(
        np.maximum(smooth, 0.4 - x[0]) + 0.3 * np.random.default_rng(5).standard_normal(lattice.shape)
    )


@dataclass(frozen=True)
class Rough:
    """State- and time-dependent drift and gains on every axis: nothing a table could leave out."""

    n: int
    separable: bool = False
    varies: bool = True

    @property
    def bounds(self) -> list[Any]:
        if self.separable:
            return [(Box(np.array([-0.5, -1.0]), np.array([0.7, 1.0])), "min", 0.0)]
        return [
            (Ball(np.array([0.1, -0.2]), 0.8), "min", 0.0),
            (Box(np.array([-0.3, -0.2]), np.array([0.3, 0.2])), "max", 0.05),
        ]

    def rates(self, lattice: Lattice, time: float) -> Rates:
        x = lattice.coordinates()
        n = self.n
        drift = [[np.cos(x[i - 1] + time), x[i] * x[i - 2], 0.1 * x[0]] for i in range(n)]
        if self.separable:
            columns = [[np.cos(x[-1]) if i == c else None for i in range(n)] for c in (0, 1)]
            return Rates(drift, [columns])
        first = [[np.sin(x[i - 1]) + c for i in range(n)] for c in (0, 1)]
        second = [[np.ones((1,) * n) if i == c else None for i in range(n)] for c in (0, 1)]
        return Rates(drift, [first, second])

    def gains_at(self, states: np.ndarray, time: float) -> list[np.ndarray]:
        """G (..., n, 2) per input, of the same functions as the rates on the nodes."""
        n, two = self.n, np.zeros((*states.shape, 2))
        if self.separable:
            two[..., [0, 1], [0, 1]] = np.cos(states[..., -1:])
            return [two]
        before = np.sin(np.roll(states, 1, axis=-1))
        return [np.stack([before, before + 1.0], axis=-1), two + np.eye(n)[:, :2]]


def rough_lattice(n: int, boundary: str) -> Lattice:
    return Lattice.of([-1.0] * n, [1.0 + 0.1 * i for i in range(n)], SHAPES[n], boundary)


@pytest.mark.parametrize("precision", ["float64", "float32"])
@pytest.mark.parametrize("boundary", list(Boundary))
@pytest.mark.parametrize("n", SHAPES)
def test_a_stage_is_what_the_twin_computes(n: int, boundary: str, precision: str) -> None:
    """Every scheme, flux and set on rough data, in 2 to 6 dimensions."""
    lattice, dt, time = rough_lattice(n, boundary), 1e-3, 0.7
    values = wavy(lattice)
    cases = [(scheme, Flux.LAX_FRIEDRICHS, Kind.FIXED) for scheme in Scheme]
    cases += [(Scheme.FIRST, Flux.GODUNOV, Kind.TUBE), (Scheme.WENO5, Flux.GODUNOV, Kind.ALWAYS)]
    for scheme, flux, kind in cases:
        motion = Rough(n, separable=flux is Flux.GODUNOV)
        march = March(
            lattice, motion, values, time, kind, Options(scheme, stages=1, flux=flux, precision=precision)
        )
        assert march.step(dt) == dt
        gain = (march.nodes() - values) / dt
        expected = (euler(lattice, motion, values, dt, time, scheme, flux, kind) - values) / dt
        scale = np.abs(expected).max()
        atol = 1e-10 if precision == "float64" else 2e-3
        differs = np.abs(gain - expected) > atol * scale
        # In float32 an ENO stencil may be chosen otherwise where two are equally rough.
        allowed = 0.01 if precision == "float32" and scheme in (Scheme.ENO2, Scheme.ENO3) else 0.0
        assert differs.mean() <= allowed, (scheme, flux, kind, np.abs(gain - expected).max() / scale)


def test_the_step_is_the_longest_stable_one() -> None:
    lattice, motion = rough_lattice(3, "edge"), Rough(3, separable=True)
    march = March(lattice, motion, wavy(lattice), 0.0, Kind.FIXED, Options(Scheme.FIRST))
    x = lattice.coordinates()
    speeds = [sum(terms) for terms in motion.rates(lattice, 0.0).drift]
    speeds[0] = abs(speeds[0] + 0.1 * np.cos(x[2])) + 0.6 * np.cos(x[2])
    speeds[1] = abs(speeds[1]) + np.cos(x[2])
    total = sum(np.abs(s) / h for s, h in zip(speeds, lattice.spacing, strict=True))
    assert march.rate == pytest.approx(total.max(), rel=1e-12)
    assert march.step(10.0) == pytest.approx(0.75 / total.max(), rel=1e-12)


@pytest.mark.parametrize("stages", [1, 2, 3])
def test_runge_kutta_against_the_twin(stages: int) -> None:
    lattice, motion, dt, t = rough_lattice(3, "periodic"), Rough(3), 2e-3, 0.3
    v = wavy(lattice)

    def push(values: np.ndarray, time: float) -> np.ndarray:
        return euler(lattice, motion, values, dt, time, Scheme.WENO3)

    if stages == 1:
        expected = push(v, t)
    elif stages == 2:
        expected = (v + push(push(v, t), t - dt)) / 2
    else:
        second = 0.75 * v + 0.25 * push(push(v, t), t - dt)
        expected = v / 3 + 2 / 3 * push(second, t - dt / 2)
    march = March(lattice, motion, v, t, Kind.FIXED, Options(Scheme.WENO3, stages=stages))
    march.step(dt)
    np.testing.assert_allclose(march.nodes(), expected, rtol=0, atol=1e-12)
    assert march.time == pytest.approx(t - dt)


def test_threads_change_nothing() -> None:
    lattice = rough_lattice(4, "extrapolate")
    values = wavy(lattice)
    one, many = (
        solve(lattice, Rough(4), values, 0.01, kind="fixed", options=Options(Scheme.WENO5, threads=k)).field
        for k in (1, 5)
    )
    assert one is not None
    assert many is not None
    np.testing.assert_array_equal(one.values, many.values)


DOUBLE = np.array([[0.0, 1.0], [0.0, 0.0]])
PUSH = np.array([[0.0], [1.0]])


def box(half: float) -> Box:
    return Box(np.array([-half]), np.array([half]))


def solved(*arguments: Any, **options: Any) -> ValueField:
    solution = solve(*arguments, **options)
    assert solution.field is not None, solution.failure
    return solution.field


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


def test_a_poisoned_boundary_has_no_field() -> None:
    """x' = x carries values in from beyond the wall, where the extrapolation grows without bound."""
    lattice = Lattice.of([-1.0, -1.0], [1.0, 1.0], (21, 21), "extrapolate_away_from_zero")
    x, y = lattice.coordinates()
    values = x**2 - y**2
    bad = solve(lattice, Linear(-np.eye(2)), values, 5.0, kind="fixed", options=Options(Scheme.FIRST))
    good = solve(
        Lattice.of([-1.0, -1.0], [1.0, 1.0], (21, 21)), Linear(-np.eye(2)), values, 5.0, kind="fixed"
    )
    away = solve(lattice, Linear(np.eye(2)), values, 5.0, kind="fixed", options=Options(Scheme.FIRST))
    assert good.field is not None, good.failure
    assert bad.field is not None, bad.failure
    assert away.field is None
    assert "poisoned" in away.failure
    with pytest.raises(InvalidInput, match="did not fail"):
        away.optimal_inputs(np.zeros((1, 2)))


def test_values_that_overflow_have_no_field() -> None:
    lattice = Lattice.of([-1.0, -1.0], [1.0, 1.0], (21, 21))
    x, y = lattice.coordinates()
    huge = 1e30 * np.sin(9.0 * x + y)
    motion = Linear(np.eye(2))
    failed = solve(lattice, motion, huge, 0.5, options=Options(Scheme.WENO5, precision="float32"))
    assert failed.field is None
    assert "not finite" in failed.failure


def test_progress_and_dismissal() -> None:
    lattice = rough_lattice(2, "edge")
    x, v = lattice.coordinates()
    values, seen = np.hypot(x, v), list[float]()
    context = Context(lambda done, total, _: seen.append(done / total))
    motion = Linear(DOUBLE, (Input(PUSH, box(1.0), "min"),))
    solved(lattice, motion, values, 2.0, context=context)
    assert len(seen) > 5
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(1.0)
    with pytest.raises(Cancelled):
        solve(lattice, motion, values, 2.0, context=Context(cancelled=lambda: True))


def test_memory_is_at_most_six_grids() -> None:
    lattice = Lattice.of([-1.0] * 4, [1.0] * 4, (40, 21, 21, 21))
    x = lattice.coordinates()
    values = np.broadcast_to(np.hypot(x[0], x[1]) - 0.5, lattice.shape)
    motion = Linear(np.eye(4)[[1, 2, 3, 0]], (Input(np.eye(4)[:, 2:], Ball(np.zeros(2), 0.1), "min"),))
    tracemalloc.start()
    solved(lattice, motion, values, 0.05, options=Options(Scheme.WENO5))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak <= 6 * values.size * 8


class TestField:
    """Reading between nodes."""

    LATTICE = Lattice.of(
        [-1.0, 0.0, -2.0], [1.0, 2.0 * np.pi, 2.0], (21, 40, 17), ["edge", "periodic", "edge"]
    )

    def field(self) -> ValueField:
        x, a, z = self.LATTICE.coordinates()
        return ValueField(self.LATTICE, 2.0 * x - 3.0 * z + np.sin(a))

    def test_value_and_gradient(self) -> None:
        states = np.stack([RNG.uniform(-1, 1, 50), RNG.uniform(-9, 9, 50), RNG.uniform(-2, 2, 50)], axis=-1)
        value, gradient = self.field().read(states)
        np.testing.assert_allclose(
            value, 2 * states[:, 0] - 3 * states[:, 2] + np.sin(states[:, 1]), atol=4e-3
        )
        np.testing.assert_allclose(gradient[:, [0, 2]], np.tile([2.0, -3.0], (50, 1)), atol=1e-12)
        np.testing.assert_allclose(gradient[:, 1], np.cos(states[:, 1]), atol=1e-2)
        corner = np.array([1.0, 2.0 * np.pi, 2.0])
        np.testing.assert_allclose(self.field().value_at(corner), -4.0, atol=1e-12)

    @pytest.mark.parametrize(
        "state", [[1.1, 0.0, 0.0], [0.0, 0.0, -2.1], [np.nan, 0.0, 0.0], [0.0, np.inf, 0.0], [0.0, 0.0]]
    )
    def test_outside_is_an_error(self, state: list[float]) -> None:
        with pytest.raises(InvalidInput, match="states"):
            self.field().gradient_at(np.array(state))


def test_optimal_inputs_are_the_best_of_many() -> None:
    motion = Linear(
        np.zeros((3, 3)),
        (
            Input(RNG.standard_normal((3, 2)), Ball(np.array([0.1, 0.2]), 0.7), "max"),
            Input(RNG.standard_normal((3, 2)), Box(np.array([-1.0, 0.0]), np.array([0.5, 2.0])), "min"),
        ),
    )
    gradient, states = RNG.standard_normal((20, 3)), np.zeros((20, 3))
    ball, corner = optimal_inputs(motion, gradient, states)
    some = RNG.standard_normal((400, 2))
    some *= 0.7 * np.sqrt(RNG.uniform(0, 1, (400, 1))) / np.linalg.norm(some, axis=1, keepdims=True)
    slope = gradient @ motion.inputs[0].matrix
    assert (
        (slope * ball).sum(axis=1)[:, None] >= slope @ (some + motion.inputs[0].bound.middle).T - 1e-12
    ).all()
    assert np.allclose(np.linalg.norm(ball - [0.1, 0.2], axis=1), 0.7)
    others = RNG.uniform([-1.0, 0.0], [0.5, 2.0], (400, 2))
    slope = gradient @ motion.inputs[1].matrix
    assert ((slope * corner).sum(axis=1)[:, None] <= slope @ others.T + 1e-12).all()


@pytest.mark.parametrize("separable", [False, True])
def test_optimal_inputs_follow_gains_that_vary(separable: bool) -> None:
    """At nodes, where the gains of the rates are known: the support functions of the Hamiltonian are attained."""
    lattice, motion = rough_lattice(3, "edge"), Rough(3, separable)
    values = wavy(lattice)
    solution = solve(lattice, motion, values, 1e-3, options=Options(Scheme.FIRST))
    assert solution.field is not None
    at = np.array([3, 5, 2])
    state = np.array([axis[k] for axis, k in zip(lattice.axes, at, strict=True)])
    gradient = solution.field.gradient_at(state)
    chosen = solution.optimal_inputs(state)
    columns = [
        [
            [0.0 if g is None else np.broadcast_to(g, lattice.shape)[tuple(at)] for g in column]
            for column in player
        ]
        for player in motion.rates(lattice, solution.time).gains
    ]
    for (bound, aim, price), gains, u in zip(motion.bounds, columns, chosen, strict=True):
        slope = np.array(gains) @ gradient
        if isinstance(bound, Ball):
            most = bound.radius * np.linalg.norm(slope)
        else:
            most = (bound.half * np.abs(slope) * (np.abs(slope) > price)).sum()
        sign = 1.0 if aim == "max" else -1.0
        assert slope @ (u - bound.middle) == pytest.approx(sign * most, rel=1e-9)


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


BAD: list[Any] = [
    lambda lattice, motion, values: solve(lattice, motion, values, -1.0),
    lambda lattice, motion, values: solve(lattice, motion, values, np.nan),
    lambda lattice, motion, values: solve(lattice, motion, values[1:], 1.0),
    lambda lattice, motion, values: solve(lattice, motion, np.full(lattice.shape, np.nan), 1.0),
    lambda lattice, motion, values: solve(lattice, object(), values, 1.0),
    lambda lattice, motion, values: solve(lattice, Linear(np.eye(3)), values, 1.0),
    lambda lattice, motion, values: solve(lattice, Linear(1e9 * np.eye(2)), values, 1.0),
    lambda lattice, motion, values: Lattice.of([0.0], [1.0], [9]),
    lambda lattice, motion, values: Lattice.of([0.0, 1.0], [1.0, 1.0], [9, 9]),
    lambda lattice, motion, values: Lattice.of([0.0, 0.0], [1.0, np.inf], [9, 9]),
    lambda lattice, motion, values: Lattice.of([0.0, 0.0], [1.0, 1.0], [9, 3]),
    lambda lattice, motion, values: Linear(np.eye(2), (Input(np.eye(3), box(1.0), "min"),)),
    lambda lattice, motion, values: Linear(np.eye(2), (Input(PUSH, box(-1.0), "min"),)),
    lambda lattice, motion, values: Linear(np.eye(2), (Input(PUSH, box(1.0), "least"),)),  # type: ignore[arg-type]
    lambda lattice, motion, values: Linear(np.eye(2), (Input(PUSH, box(1.0), "min", -1.0),)),
    lambda lattice, motion, values: Options(stages=4),
    lambda lattice, motion, values: Options(precision="float16"),
    lambda lattice, motion, values: Options(courant=1.5),
    lambda lattice, motion, values: solve(
        lattice,
        Linear(np.zeros((2, 2)), (Input(np.eye(2), Ball(np.zeros(2), 1.0), "min"),)),
        values,
        1.0,
        options=Options(flux=Flux.GODUNOV),
    ),
]


@pytest.mark.parametrize("case", range(len(BAD)))
def test_bad_input_is_refused(case: int) -> None:
    lattice = Lattice.of([-1.0, -1.0], [1.0, 1.0], (9, 9))
    x, y = lattice.coordinates()
    with pytest.raises(InvalidInput):
        BAD[case](lattice, Linear(np.zeros((2, 2))), x + y)

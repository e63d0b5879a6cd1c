"""Euler-Poinsot motion against an integrator, its invariants and limits; tables; LVLH on any orbit."""

import math
import time

import numpy as np
import pytest
from flint import acb, arb
from scipy.integrate import solve_ivp

from safestart.attitude.elliptic import Jacobi
from safestart.attitude.in_lvlh import InLvlh, torque_free
from safestart.attitude.quaternion import matrix_of
from safestart.attitude.table import Table
from safestart.attitude.torque_free import TorqueFree
from safestart.errors import InvalidInput
from safestart.model.orbit import KeplerOrbit
from safestart.runtime.precision import precise

TIMES = np.linspace(0.0, 200.0, 21)
KINDS = ("general", "axisymmetric", "ball", "separatrix", "principal")


def drawn(kind: str, rng: np.random.Generator) -> tuple[tuple, tuple, tuple]:
    """A body, an attitude and a rate of 0.01 to 0.1 rad/s, near where the formulas change."""
    shares = rng.uniform(0.2, 1.0, 3)
    moments = 1000.0 * np.array([shares[1] + shares[2], shares[0] + shares[2], shares[0] + shares[1]])
    if kind == "axisymmetric":
        moments[1] = moments[0] * (1.0 + rng.choice([0.0, 1e-15, 1e-12, 1e-8, 1e-4, -1e-9]))
    if kind == "ball":
        moments[:] = moments[0] * (1.0 + rng.choice([0.0, 1e-15, 1e-9], 3))
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    rate = 0.04 * rng.normal(size=3)
    if kind in ("separatrix", "principal"):
        turn = np.eye(3)
    if kind == "separatrix":
        order = np.argsort(moments)
        a, b, c = moments[order]
        rate[order[2]] = math.sqrt(a * (b - a) / (c * (c - b))) * rate[order[0]]
        rate[order[2]] *= 1.0 + rng.choice([0.0, 1e-14, 1e-10, 1e-6, -1e-7])
    if kind == "principal":
        rate = np.eye(3)[rng.integers(3)] * 0.05 + rng.choice([0.0, 1e-9, 1e-5]) * rng.normal(size=3)
    inertia = turn @ np.diag(moments) @ turn.T
    inertia = 0.5 * (inertia + inertia.T)
    return tuple(map(tuple, inertia)), tuple(rng.normal(size=4)), tuple(turn @ rate)


def integrated(inertia: tuple, attitude: tuple, rate: tuple, times: np.ndarray) -> tuple:
    """Euler's equations and C' = -[w x] C by DOP853."""
    moment = np.array(inertia)
    inverse = np.linalg.inv(moment)

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        w, c = y[:3], y[3:].reshape(3, 3)
        turn = -np.cross(w, c, axisb=0, axisc=0)
        return np.concatenate([inverse @ -np.cross(w, moment @ w), turn.ravel()])

    first = matrix_of(np.array(attitude) / np.linalg.norm(attitude))
    begin = np.concatenate([rate, first.ravel()])
    found = solve_ivp(rates, (0.0, times[-1]), begin, "DOP853", times, rtol=3e-14, atol=1e-15)
    return found.y[:3].T, found.y[3:].T.reshape(-1, 3, 3)


@pytest.mark.parametrize("kind", KINDS)
def test_equals_an_integrator(kind: str) -> None:
    rng = np.random.default_rng(KINDS.index(kind))
    for _ in range(6):
        body = drawn(kind, rng)
        motion = TorqueFree(*body)
        rate, turn = integrated(*body, TIMES)
        np.testing.assert_allclose(motion.rotation(TIMES), turn, rtol=0.0, atol=1e-11)
        np.testing.assert_allclose(motion.angular_velocity(TIMES), rate, rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("kind", KINDS)
def test_invariants_hold_for_an_hour(kind: str) -> None:
    rng, times = np.random.default_rng(7 + KINDS.index(kind)), np.linspace(0.0, 3600.0, 500)
    for _ in range(8):
        inertia, attitude, rate = drawn(kind, rng)
        motion, moment = TorqueFree(inertia, attitude, rate), np.array(inertia)
        turn, w = motion.rotation(times), motion.angular_velocity(times)
        momentum = np.einsum("tji,tj->ti", turn, w @ moment)
        size = np.linalg.norm(momentum[0])
        assert np.abs(momentum - momentum[0]).max() < 1e-13 * size
        energy = np.einsum("ti,ij,tj->t", w, moment, w)
        assert np.abs(energy / energy[0] - 1.0).max() < 1e-13
        assert np.abs(turn @ turn.swapaxes(1, 2) - np.eye(3)).max() < 1e-13
        fast, changing = motion.rate_bounds()
        assert np.linalg.norm(w, axis=1).max() <= fast
        step = 1e-2
        change = (motion.angular_velocity(times + step) - motion.angular_velocity(times - step)) / (
            2.0 * step
        )
        assert np.linalg.norm(change, axis=1).max() <= changing * (1.0 + 1e-6) + 1e-12


def test_elliptic_functions_near_both_ends() -> None:
    """Against theta functions in ball arithmetic, at m1 = 1e-13, m = 1e-13 and between, several half periods on."""
    u = np.array([0.3, 14.2, 18.9, -40.7])
    for parameter, complement in ((1.0 - 1e-13, 1e-13), (1e-13, 1.0 - 1e-13), (0.4, 0.6)):
        found = Jacobi(parameter, complement).functions(u)
        with precise(300):
            m = 1 - arb(complement) if complement < 0.5 else arb(parameter)
            quarter, other = acb(m).elliptic_k(), acb(1 - m).elliptic_k()
            nome = acb(0, 1) * other / quarter
            _, t2, t3, t4 = acb(0).modular_theta(nome)[:4]
            for k, value in enumerate(u.tolist()):
                # z counts in units of pi there.
                a1, a2, a3, a4 = (acb(value) / (2 * quarter)).modular_theta(nome)[:4]
                expected = (t3 * a1 / (t2 * a4), t4 * a2 / (t2 * a4), t4 * a3 / (t3 * a4))
                for values, exact in zip(found, expected, strict=True):
                    assert abs(values[k] - float(exact.real.mid())) < 2e-13


@pytest.mark.parametrize("orbit", [KeplerOrbit(1.1e-3), KeplerOrbit.of(2.6e7, 0.7, -0.4)])
@pytest.mark.parametrize("reference", ["inertial", "lvlh"])
def test_lvlh_turns_under_it(orbit: KeplerOrbit, reference: str) -> None:
    """The attitude from LVLH is the inertial one turned back, and turns at the velocity it says."""
    inertia, attitude, rate = drawn("general", np.random.default_rng(3))
    seen = torque_free(inertia, attitude, rate, reference, orbit)
    assert isinstance(seen, InLvlh)
    times, h = np.array([0.0, 55.0, 900.0, 3000.0]), 1e-3
    back = orbit.rotation(times)
    np.testing.assert_allclose(seen.rotation(times) @ back, seen.inertial.rotation(times), atol=1e-13)
    turn, omega = seen.moving(times)
    assert turn.tobytes() == seen.rotation(times).tobytes()
    assert omega.tobytes() == seen.angular_velocity(times).tobytes()
    np.testing.assert_allclose(
        seen.rotation(times)[0], matrix_of(np.array(attitude) / np.linalg.norm(attitude)), atol=1e-14
    )
    change = (seen.rotation(times + h) - seen.rotation(times - h)) / (2.0 * h)
    omega = seen.angular_velocity(times)
    for turn, rise, w in zip(seen.rotation(times), change, omega, strict=True):
        np.testing.assert_allclose(rise, -np.cross(w, turn, axisb=0, axisc=0), atol=1e-9)
    expected = np.array(rate)
    if reference == "inertial":
        expected = expected - orbit.rate(np.zeros(1))[0] * seen.rotation(times)[0][:, 2]
    np.testing.assert_allclose(omega[0], expected, atol=1e-14)
    assert np.linalg.norm(omega, axis=1).max() <= seen.rate_bounds()[0]


def test_orbit_turns_as_an_integrator_says() -> None:
    orbit = KeplerOrbit.of(4.0e7, 0.8, 2.5)
    p = 4.0e7 * (1.0 - 0.8**2)
    momentum = math.sqrt(3.986004418e14 * p)

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        return np.array([momentum * ((1.0 + 0.8 * math.cos(y[0])) / p) ** 2])

    times = np.linspace(0.0, 2.0e5, 41)
    found = solve_ivp(rates, (0.0, 2.0e5), [2.5], "DOP853", times, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(orbit.turned(times), found.y[0] - 2.5, atol=1e-10)
    np.testing.assert_allclose(orbit.rate(times), [rates(0.0, y)[0] for y in found.y.T], rtol=1e-9)


def test_table_is_slerp() -> None:
    """A steady turn is met exactly between coarse entries, whatever the sign of the quaternions."""
    axis, rate = np.array([0.6, 0.0, 0.8]), 0.1
    at = np.arange(0.0, 61.0, 10.0)
    entries = np.column_stack([np.cos(0.05 * at), np.sin(0.05 * at)[:, None] * axis])
    entries[2::3] *= -1.0
    table, times = Table(tuple(at), tuple(map(tuple, entries))), np.linspace(0.0, 60.0, 37)
    exact = matrix_of(
        np.column_stack([np.cos(0.5 * rate * times), np.sin(0.5 * rate * times)[:, None] * axis])
    )
    np.testing.assert_allclose(table.rotation(times), exact, atol=1e-14)
    np.testing.assert_allclose(table.angular_velocity(times), np.tile(rate * axis, (37, 1)), atol=1e-14)
    with pytest.raises(InvalidInput, match="up to the end"):
        table.reaches(61.0)


@pytest.mark.parametrize(
    ("inertia", "attitude", "rate", "field"),
    [
        (((1.0, 0.1, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (1, 0, 0, 0), (0, 0, 0), "inertia"),
        (((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 2.1)), (1, 0, 0, 0), (0, 0, 0), "inertia"),
        (((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)), (1, 0, 0, 0), (0, 0, 0), "inertia"),
        (((1.0, 0.0), (0.0, 1.0)), (1, 0, 0, 0), (0, 0, 0), "inertia"),
        (((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.5)), (0, 0, 0, 0), (0, 0, 0), "attitude"),
        (((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.5)), (1, 0, 0, 0), (0, 2.0, 0), "body_rate"),
    ],
)
def test_what_is_no_body_is_refused(inertia: tuple, attitude: tuple, rate: tuple, field: str) -> None:
    with pytest.raises(InvalidInput) as refused:
        TorqueFree(inertia, attitude, rate)
    assert refused.value.field == field


@pytest.mark.parametrize(
    ("times", "entries", "field"),
    [
        ((0.0, 10.0), ((1, 0, 0, 0), (0, 0, 0, 0)), "attitude"),
        ((0.0, 10.0), ((1, 0, 0, 0), (0, 1, 0, 0)), "attitude"),
        ((0.0, 0.5), ((1, 0, 0, 0), (1, 1, 0, 0)), "attitude"),
        ((1.0, 10.0), ((1, 0, 0, 0), (1, 0, 0, 0)), "times"),
        ((0.0, 0.0), ((1, 0, 0, 0), (1, 0, 0, 0)), "times"),
    ],
)
def test_what_is_no_table_is_refused(times: tuple, entries: tuple, field: str) -> None:
    with pytest.raises(InvalidInput) as refused:
        Table(times, entries)
    assert refused.value.field == field


def test_orbits_into_the_earth_are_refused() -> None:
    with pytest.raises(InvalidInput, match="perigee"):
        KeplerOrbit.of(8.0e6, 0.3)
    with pytest.raises(InvalidInput):
        KeplerOrbit.of(4.0e7, 0.81)


def test_ten_thousand_times_are_quick() -> None:
    """About 2 ms on a quiet core; a tenfold allowance, because machines of tests are not quiet."""
    seen = torque_free(*drawn("general", np.random.default_rng(5)), "inertial", KeplerOrbit(1.1e-3))
    times, spent = np.linspace(0.0, 3600.0, 10_000), []
    for _ in range(7):
        begin = time.process_time()
        seen.rotation(times)
        spent.append(time.process_time() - begin)
    assert min(spent) < 20e-3


@pytest.mark.parametrize("orbit", [KeplerOrbit(1.1e-3), KeplerOrbit.of(3.3e7, 0.8, -0.3)])
def test_bounds_on_four_derivatives_hold(orbit: KeplerOrbit) -> None:
    """Of a direction of the body, of LVLH's turn and of the tide, by differences."""
    h, at = 2.0, np.linspace(0.0, 900.0, 61)
    offsets = h * np.arange(-3, 4)
    stencils = (
        (np.array([0, 0, -0.5, 0, 0.5, 0, 0]), 1),
        (np.array([0, 0, 1.0, -2.0, 1.0, 0, 0]), 2),
        (np.array([0, -0.5, 1.0, 0, -1.0, 0.5, 0]), 3),
        (np.array([0, 1.0, -4.0, 6.0, -4.0, 1.0, 0]), 4),
    )
    rng = np.random.default_rng(11)
    for kind in KINDS:
        seen = torque_free(*drawn(kind, rng), "inertial", orbit)
        rows = seen.rotation(at[:, None] + offsets)
        for (weights, order), bound in zip(stencils, seen.turn_bounds(), strict=True):
            found = np.einsum("s,tsij->tij", weights, rows) / h**order
            assert np.linalg.norm(found, axis=2).max() <= bound * 1.01 + 1e-14 / h**order
    angles, rate = orbit.turned(at[:, None] + offsets), orbit.rate(at[:, None] + offsets)
    pace = orbit.mean_motion / (1.0 - orbit.eccentricity**2) ** 1.5
    tide = pace**2 * (rate / pace) ** 1.5
    for (weights, order), bound in zip(stencils, orbit.turn_bounds(), strict=True):
        assert np.abs(angles @ weights).max() / h**order <= bound * 1.01 + 1e-13
    assert tide.max() <= orbit.tide_bounds()[0] * (1.0 + 1e-12)
    for (weights, order), bound in zip(stencils[:2], orbit.tide_bounds()[1:], strict=True):
        assert np.abs(tide @ weights).max() / h**order <= bound * 1.01 + 1e-18

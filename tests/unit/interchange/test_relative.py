"""Relative states against brahe and against 200-bit arithmetic; frames against brahe; covariance against samples."""

import math

import brahe
import numpy as np
import pytest
from flint import arb

from safestart.errors import InvalidInput
from safestart.interchange.covariance import Covariance, box_at, into_axes, other_sense
from safestart.interchange.ephemeris import Ephemeris
from safestart.interchange.epochs import SECOND
from safestart.interchange.frames import EARTH_TURN, to_gcrf
from safestart.interchange.relative import (
    covariance_in_lvlh,
    in_lvlh,
    lvlh_axes,
    relative_states,
    to_inertial,
)
from safestart.model.orbit import EARTH_RADIUS
from safestart.runtime.precision import precise
from tests.unit.interchange.sample import BEGIN, course, kepler


def _pairs(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Chasers and targets (K, 6): orbits up to e = 0.7, up to some 100 km apart."""
    rng = np.random.default_rng(19)
    target, chaser = np.empty((count, 6)), np.empty((count, 6))
    for k in range(count):
        e = rng.uniform(0.0, 0.7)
        a = (EARTH_RADIUS + rng.uniform(3e5, 3e7)) / (1.0 - e)
        angles, mean = (
            (rng.uniform(0, 6.28), rng.uniform(0, 3.14), rng.uniform(0, 6.28)),
            rng.uniform(0, 6.28),
        )
        (target[k],) = kepler(a, e, angles, mean, np.zeros(1))
        chaser[k] = (
            target[k]
            + np.r_[
                rng.normal(size=3) * 10 ** rng.uniform(0, 5), rng.normal(size=3) * 10 ** rng.uniform(-2, 2)
            ]
        )
    return chaser, target


def test_a_thousand_pairs_against_another_library() -> None:
    chaser, target = _pairs(1000)
    ours = in_lvlh(chaser, target, *lvlh_axes(target))
    theirs = np.array([brahe.state_eci_to_rtn(t, c) for c, t in zip(chaser, target, strict=True)])
    assert np.abs(ours[:, :3] - theirs[:, :3]).max() < 1e-6
    assert np.abs(ours[:, 3:] - theirs[:, 3:]).max() < 1e-9
    np.testing.assert_allclose(to_inertial(ours, target), chaser, rtol=1e-14, atol=1e-9)


def test_velocity_is_the_derivative_in_the_turning_axes() -> None:
    """Axes and position a moment earlier and later, in 200 bits: of r and v alone along the true acceleration."""
    chaser, target = _pairs(1000)
    ours = in_lvlh(chaser, target, *lvlh_axes(target))
    with precise(200):
        h = arb(10) ** -12
        for k in range(1000):
            ahead, behind = (_seen(chaser[k], target[k], sign * h) for sign in (1, -1))
            for axis in range(3):
                assert abs((ahead[axis] - behind[axis]) / (2 * h) - arb(float(ours[k, 3 + axis]))) < 1e-9
                assert abs((ahead[axis] + behind[axis]) / 2 - arb(float(ours[k, axis]))) < 1e-6


def _seen(chaser: np.ndarray, target: np.ndarray, dt: arb) -> list[arb]:
    """Position in LVLH a moment on, when both coast."""
    r, v = ([arb(float(e)) for e in part] for part in (target[:3], target[3:]))
    p = [
        arb(float(c)) - t + (arb(float(w)) - u) * dt
        for c, t, w, u in zip(chaser[:3], r, chaser[3:], v, strict=True)
    ]
    size = sum(e * e for e in r).sqrt()
    pull = [-arb("3.986004418e14") * e / size**3 for e in r]
    r = [e + u * dt for e, u in zip(r, v, strict=True)]
    v = [u + g * dt for u, g in zip(v, pull, strict=True)]
    x = _unit(r)
    z = _unit(_cross(r, v))
    y = _cross(z, x)
    return [sum(a * b for a, b in zip(axis, p, strict=True)) for axis in (x, y, z)]


def _unit(v: list[arb]) -> list[arb]:
    size = sum(e * e for e in v).sqrt()
    return [e / size for e in v]


def _cross(a: list[arb], b: list[arb]) -> list[arb]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def test_frames_against_another_library() -> None:
    brahe.set_global_eop_provider(brahe.StaticEOPProvider.from_zero())
    given = course(count=5, step=3000.0, covariance=None)
    for name, their in (
        ("EME2000", lambda at, x: brahe.state_eme2000_to_gcrf(x)),
        ("TEME", brahe.state_teme_to_gcrf),
        ("ITRF", brahe.state_itrf_to_gcrf),
    ):
        ours = to_gcrf(name, given.epochs, given.states)
        for k in range(5):
            at = brahe.Epoch.from_datetime(2026, 3, 1, 12, 0, 0.0, 0.0, brahe.TimeSystem.UTC) + 3000.0 * k
            theirs = their(at, given.states[k])
            # The other library knows the bias to 1e-12 rad. TEME of 1976, 1980 is near that of 2006.
            near = {"EME2000": 1e-4, "TEME": 5.0, "ITRF": 1e-2}[name]
            assert np.abs(ours[k, :3] - theirs[:3]).max() < near, name
            assert np.abs(ours[k, 3:] - theirs[3:]).max() < 1.1e-3 * near + 1e-9, name


def test_states_between_epochs_and_in_different_frames() -> None:
    """A chaser every 60 s in TEME and a target every 45 s in GCRF, asked at other times."""
    times_c, times_t = np.arange(0.0, 3600.0, 60.0), np.arange(0.0, 3600.0, 45.0)
    angles = (0.4, 0.9, 1.3)
    at = BEGIN + np.rint(np.arange(301.0, 3000.0, 77.0) * SECOND).astype(np.int64)
    seconds = (at - BEGIN) / SECOND

    def gcrf(mean: float, times: np.ndarray) -> Ephemeris:
        epochs = BEGIN + np.rint(times * SECOND).astype(np.int64)
        return Ephemeris("A", "1", "GCRF", "UTC", epochs, kepler(7e6, 0.01, angles, mean, times))

    chaser, target = gcrf(0.3 + 1e-6, times_c), gcrf(0.3, times_t)
    found = relative_states(chaser, target, at)
    assert found.known.all()
    true_c, true_t = kepler(7e6, 0.01, angles, 0.3 + 1e-6, seconds), kepler(7e6, 0.01, angles, 0.3, seconds)
    truth = in_lvlh(true_c, true_t, *lvlh_axes(true_t))
    assert np.abs(found.states[:, :3] - truth[:, :3]).max() < 1e-6
    assert np.abs(found.states[:, 3:] - truth[:, 3:]).max() < 1e-8
    assert found.eccentricities() == pytest.approx(0.01, abs=1e-9)
    assert found.mean_motions() == pytest.approx(math.sqrt(3.986004418e14 / 7e6**3), rel=1e-9)
    # The same pair turned into ITRF and back is the same relative state to 1e-7 of the distance.
    same = relative_states(_in_itrf(chaser), _in_itrf(target), at)
    assert np.abs(same.states[:, :3] - found.states[:, :3]).max() < 1e-6


def _in_itrf(given: Ephemeris) -> Ephemeris:
    from safestart.interchange.frames import rotation_to_gcrf

    back = rotation_to_gcrf("ITRF", given.epochs)
    position = np.einsum("kji,kj->ki", back, given.states[:, :3])
    velocity = np.einsum("kji,kj->ki", back, given.states[:, 3:]) - np.cross([0.0, 0.0, EARTH_TURN], position)
    states = np.concatenate([position, velocity], axis=1)
    return Ephemeris(given.name, given.object_id, "ITRF", "UTC", given.epochs, states)


def test_nothing_is_interpolated_across_a_gap() -> None:
    given = course(count=100, covariance=None)
    kept = np.r_[0:40, 80:100]
    broken = Ephemeris("A", "1", "GCRF", "UTC", given.epochs[kept], given.states[kept])
    at = BEGIN + SECOND * np.arange(0, 1000, 5)
    found = relative_states(broken, Ephemeris("B", "2", "GCRF", "UTC", given.epochs, given.states), at)
    seconds = (at - BEGIN) / SECOND
    np.testing.assert_array_equal(found.known, (seconds <= 390) | ((seconds >= 800) & (seconds <= 990)))
    with pytest.raises(InvalidInput, match="one realisation of ITRF"):
        relative_states(Ephemeris("A", "1", "ITRF", "UTC", given.epochs, given.states), given, at)


def test_covariance_in_both_senses_against_samples() -> None:
    rng = np.random.default_rng(5)
    target = kepler(7e6, 0.1, (0.4, 0.9, 1.3), 0.3, np.zeros(1))
    chaser = target + np.array([[30.0, -80.0, 12.0, 0.02, -0.03, 0.01]])
    root = rng.normal(size=(6, 6)) * np.array([3.0, 5.0, 2.0, 0.003, 0.002, 0.004])[:, None]
    matrix = root @ root.T
    drawn = chaser + rng.multivariate_normal(np.zeros(6), matrix, size=200_000)
    (axes,), (rate,) = lvlh_axes(target)
    seen = in_lvlh(
        drawn,
        np.repeat(target, len(drawn), axis=0),
        np.repeat(axes[None], len(drawn), 0),
        np.full(len(drawn), rate),
    )
    given = Covariance(BEGIN, "GCRF", matrix)
    rotating = covariance_in_lvlh(given, chaser[0], target[0], "rotating")
    scale = np.sqrt(np.diagonal(rotating))
    assert np.abs((np.cov(seen.T) - rotating) / np.outer(scale, scale)).max() < 0.02
    inertial = covariance_in_lvlh(given, chaser[0], target[0], "inertial")
    turned = (drawn - chaser) @ np.kron(np.eye(2), axes).T
    scale = np.sqrt(np.diagonal(inertial))
    assert np.abs((np.cov(turned.T) - inertial) / np.outer(scale, scale)).max() < 0.02
    assert np.abs(rotating - inertial).max() > 1e-3
    spin = np.array([0.0, 0.0, rate])
    np.testing.assert_allclose(other_sense(inertial, spin, "rotating"), rotating, rtol=1e-9, atol=1e-12)
    # In its own moving axes, said in either sense, it is the same covariance.
    (own,), (own_rate,) = lvlh_axes(chaser)
    for sense in ("rotating", "inertial"):
        local = into_axes(matrix, own, np.array([0.0, 0.0, own_rate]), sense)
        again = covariance_in_lvlh(
            Covariance(BEGIN, f"RTN_{sense.upper()}", local), chaser[0], target[0], "rotating"
        )
        np.testing.assert_allclose(again, rotating, rtol=1e-8, atol=1e-10)


def test_the_box_holds_what_it_says() -> None:
    rng = np.random.default_rng(6)
    root = rng.normal(size=(6, 6))
    drawn = rng.multivariate_normal(np.zeros(6), root @ root.T, size=100_000)
    for dimensions, kept in ((2, [0, 1, 3, 4]), (3, [0, 1, 2, 3, 4, 5])):
        half = box_at(root @ root.T, 0.95, dimensions)
        assert 0.95 <= np.mean((np.abs(drawn[:, kept]) <= half).all(axis=1)) < 1.0

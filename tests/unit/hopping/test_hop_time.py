"""The hop-time equation: against CWH itself, its folds, its branch, its refusals, many pairs at once."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safestart.dynamics.cwh import transition_matrix
from safestart.errors import InvalidInput
from safestart.hopping.approach import departure, line
from safestart.hopping.fold import CUSP
from safestart.hopping.hop_equation import residual, weights
from safestart.hopping.hop_time import fold_deg, hop_phases, hop_time
from safestart.hopping.hop_time_kernel import compiled_hop_phases

N = 8.66e-4


def _phase(angle: float, rho: float) -> float:
    return float(hop_phases(np.array([angle]), np.array([rho]))[0])


@given(st.floats(0.01, 145.6), st.floats(0.0, 0.999))
def test_a_hop_ends_on_its_line_and_perpendicular_to_it(angle: float, rho: float) -> None:
    time = _phase(angle, rho) / N
    along = line(angle)
    state = np.concatenate([1000.0 * along, departure(N, time, 1000.0 * along, 1000.0 * rho * along)])
    there = transition_matrix(N, time) @ state
    speed = np.linalg.norm(there[3:])
    assert np.allclose(there[:3], 1000.0 * rho * along, atol=1e-8)
    assert abs(there[3:] @ along) < 1e-7 * max(speed, np.linalg.norm(state[3:]))


def test_the_v_bar_takes_half_an_orbit_for_every_share() -> None:
    shares = np.linspace(0.0, 0.999, 50)
    for angle in (0.0, 180.0, 360.0):
        assert (hop_phases(np.full(50, angle), shares) == math.pi).all()
    assert hop_time(1e-5, 0.5)[0] == pytest.approx(0.5, abs=1e-3)


def _share_left(phi: np.ndarray, theta: float) -> np.ndarray:
    """rho that a hop of phase ``phi`` (rad) along ``theta`` (rad) leaves: g = N - rho D vanishes."""
    numerator, _ = residual(phi, weights(np.array(theta), np.zeros(())))
    return numerator / (numerator - residual(phi, weights(np.array(theta), np.ones(())))[0])


def test_the_r_bar_limit_and_its_closed_form() -> None:
    assert _phase(90.0, 0.0) == pytest.approx(1.2757, abs=5e-5)
    phi = np.linspace(0.05, 1.2, 40)
    printed = (3 * phi - 4 * np.sin(phi)) / (3 * phi * np.cos(phi) - 4 * np.sin(phi))
    assert np.allclose(_share_left(phi, 0.5 * math.pi), printed, rtol=1e-12)
    assert float(_share_left(np.array(0.6), 0.5 * math.pi)) == pytest.approx(0.593, abs=5e-4)


def test_folds() -> None:
    for rho, fold in ((0.7, 147.19), (0.5, 145.68), (0.85, 151.37)):
        found = fold_deg(rho)
        assert found == pytest.approx(fold, abs=0.05)
        assert found is not None
        assert hop_time(found - 1e-6, rho)[0] > 0.1
        with pytest.raises(InvalidInput, match="angle_deg: required an angle"):
            hop_time(found + 1e-6, rho)


@pytest.mark.parametrize("rho", [CUSP + 1e-3, 0.24, 0.3, 0.5, 0.9, 0.999, 1 - 1e-6])
def test_at_a_fold_two_roots_meet(rho: float) -> None:
    fold = fold_deg(rho)
    assert fold is not None
    phases = np.linspace(1e-4, math.tau, 400_001)
    before = residual(phases, weights(np.radians(fold - 1e-3), np.array(rho)))[0]
    beyond = residual(phases, weights(np.radians(fold + 1e-3), np.array(rho)))[0]
    crossings = [int(np.sum(np.sign(g[:-1]) != np.sign(g[1:]))) for g in (before, beyond)]
    assert crossings[0] == crossings[1] + 2


def test_below_the_cusp_the_branch_reaches_the_v_bar_behind_the_target() -> None:
    assert fold_deg(CUSP - 1e-4) is None
    angles = np.linspace(100.0, 179.999, 4000)
    phases = hop_phases(angles, np.full(4000, 0.15))
    assert np.abs(np.diff(phases)).max() < 0.02
    assert phases[-1] == pytest.approx(math.pi, abs=1e-3)


def test_many_pairs_are_first_roots() -> None:
    rng = np.random.default_rng(5)
    angles, shares = rng.uniform(0.0, 180.0, 1500), rng.uniform(0.0, 0.999, 1500)
    phases = hop_phases(angles, shares)
    at = np.linspace(1e-4, 0.9 * math.tau, 6001)
    for angle, share, phase in zip(angles, shares, phases, strict=True):
        if math.isnan(phase):
            fold = fold_deg(share)
            assert fold is not None
            assert angle > fold
            continue
        value = residual(at, weights(np.radians(angle), share))[0]
        first = at[int(np.argmax(value >= 0.0))]
        assert phase == pytest.approx(first, abs=2e-3)


def test_bad_input_is_named() -> None:
    for angle, rho, field in ((40.0, 1.0, "rho"), (40.0, -0.1, "rho"), (math.inf, 0.5, "angle_deg")):
        with pytest.raises(InvalidInput) as refused:
            hop_phases(np.array([angle]), np.array([rho]))
        assert refused.value.field == field
    with pytest.raises(InvalidInput, match="rho"):
        hop_phases(np.array([40.0]), np.array([math.nan]))


def test_compiled_hop_times_are_the_same() -> None:
    rng = np.random.default_rng(2)
    angles, shares = rng.uniform(0.0, 360.0, 20_000), rng.uniform(0.0, 0.99, 20_000)
    angles[:50], angles[50:100], shares[100:150] = 0.0, 90.0, 0.0
    plain, fast = hop_phases(angles, shares), compiled_hop_phases(angles, shares)
    assert (np.isnan(plain) == np.isnan(fast)).all()
    assert 100 < np.isnan(plain).sum() < 10_000
    np.testing.assert_allclose(fast, plain, rtol=1e-11)
    for angle, share, field in ((np.inf, 0.5, "angle_deg"), (10.0, 1.5, "rho"), (10.0, -0.1, "rho")):
        with pytest.raises(InvalidInput) as refused:
            compiled_hop_phases(np.array([angle]), np.array([share]))
        assert refused.value.field == field

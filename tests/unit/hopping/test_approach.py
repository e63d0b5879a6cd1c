"""Approaches: the nominal plans of the study, distances, inverse problems, refusals."""

import numpy as np
import pytest

from safestart.dynamics.cwh import transition_matrix
from safestart.errors import InvalidInput
from safestart.hopping.approach import approach, distances, line, mean_motion_of
from safestart.hopping.inverse import curve_of, greatest_angle

N = mean_motion_of(8.1e6)


@pytest.mark.parametrize(
    ("angle", "orbits", "first", "second"),
    [
        (0.0, 2.500, 0.823, 0.823),
        (40.0, 0.694, 8.216, 6.526),
        (90.0, 0.512, 8.232, 6.019),
        (120.0, 0.624, 6.417, 4.566),
        (130.0, 0.733, 5.739, 4.109),
    ],
)
def test_nominal_plans(angle: float, orbits: float, first: float, second: float) -> None:
    plan = approach(N, angle, 2000.0, 100.0, 5)
    assert plan.orbits == pytest.approx(orbits, abs=6e-4)
    assert plan.fuel_1norm == pytest.approx(first, abs=6e-4)
    assert plan.fuel_2norm == pytest.approx(second, abs=6e-4)


def test_the_impulses_fly_the_plan() -> None:
    plan = approach(N, 220.0, 1500.0, 80.0, 4, 0.6)
    state = plan.states()[0]
    assert (state[3:] == 0.0).all()
    for hop, impulse in zip(plan.hops, plan.impulses, strict=False):
        state = state.copy()
        state[3:] += impulse
        state = transition_matrix(N, hop.time) @ state
        assert np.allclose(state[:3], hop.end * line(220.0), atol=1e-7)
    assert np.allclose(state[3:], -plan.impulses[-1], atol=1e-10)
    assert plan.times[-1] * N == pytest.approx(2 * np.pi * plan.orbits)


def test_distances() -> None:
    geometric = distances(2000.0, 100.0, 5)
    assert np.allclose(geometric[1:] / geometric[:-1], (100 / 2000) ** 0.2)
    assert np.allclose(distances(2000.0, 100.0, 5, (100 / 2000) ** 0.2), geometric)
    assert np.allclose(np.diff(distances(1000.0, 100.0, 3, 1.0)), -300.0)


def test_ten_times_the_fuel_holds_in_the_1_norm_and_five_times_faster_nearly() -> None:
    v, r = approach(N, 0.0, 2000.0, 100.0, 5), approach(N, 90.0, 2000.0, 100.0, 5)
    assert r.fuel_1norm / v.fuel_1norm == pytest.approx(10.0, abs=0.05)
    assert r.fuel_2norm / v.fuel_2norm == pytest.approx(7.3, abs=0.05)
    assert v.orbits / r.orbits == pytest.approx(4.9, abs=0.05)


def test_angles_for_a_time_or_a_fuel() -> None:
    for measure, value in (("orbits", 0.6), ("fuel_1norm", 8.5), ("fuel_2norm", 4.5)):
        angles = curve_of(measure, N, 2000.0, 100.0, 5).angles_for(value)
        assert len(angles) == 2 or measure == "fuel_2norm"
        assert angles
        for angle in angles:
            plan = approach(N, angle, 2000.0, 100.0, 5)
            reached = {"orbits": plan.orbits, "fuel_1norm": plan.fuel_1norm, "fuel_2norm": plan.fuel_2norm}
            assert reached[measure] == pytest.approx(value, abs=1e-8)
    assert curve_of("fuel_1norm", N, 2000.0, 100.0, 5).angles_for(20.0) == []
    assert greatest_angle(2000.0, 100.0, 5) == pytest.approx(145.7, abs=0.2)


@pytest.mark.parametrize(
    ("changed", "field"),
    [
        ({"hold": 2000.0}, "start_m"),
        ({"hold": -1.0}, "hold_m"),
        ({"hops": 0}, "hops"),
        ({"gamma": 1.5}, "gamma"),
        ({"gamma": 1e-9}, "gamma"),
        ({"angle_deg": 160.0}, "angle_deg"),
    ],
)
def test_refusals(changed: dict[str, float], field: str) -> None:
    asked = {"mean_motion": N, "angle_deg": 0.0, "start": 2000.0, "hold": 100.0, "hops": 5, **changed}
    with pytest.raises(InvalidInput) as refused:
        approach(**asked)  # type: ignore[arg-type]
    assert refused.value.field == field
    with pytest.raises(InvalidInput, match="semi_major_axis_m"):
        mean_motion_of(6.3e6)

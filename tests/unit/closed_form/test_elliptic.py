"""The certificate on elliptic orbits: the circular one at e = 0, and flights in inertial space."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from safestart.closed_form.certified import certify
from safestart.closed_form.elliptic import (
    EllipticScenario,
    certify_elliptic,
    elliptic_rates,
    largest_eccentricity,
)
from safestart.closed_form.family import SPANS
from safestart.closed_form.manoeuvre import Manoeuvre, _braking, _turning_in
from safestart.closed_form.members import BRAKE
from safestart.constraints.corridor import corridor_of
from safestart.errors import InvalidInput
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import Chaser, CorridorShape, Floats, Rest, Scenario, Target

SHAPE = CorridorShape()


@pytest.mark.parametrize("rest", list(Rest))
def test_a_circular_orbit_gives_the_certificate(rest: Rest) -> None:
    omega, n = math.radians(1.0), 1.1e-3
    random = np.random.Generator(np.random.Philox(1))
    points = random.uniform([-200, 0, -100], [200, 200, 100], (4000, 3))
    old = certify(Scenario(Target(omega, n), Chaser(0.02), SHAPE), points, rest)
    new = certify_elliptic(EllipticScenario(omega + n, n, 0.0, 1.0, 0.02, SHAPE), points, rest)
    assert old.go.sum() > 100
    assert (new.go == old.go).mean() > 0.9995
    both = old.go & new.go
    # Each rounds by its own way to the same sums; a member may change at its last digit.
    assert np.median(np.abs(new.margin - old.margin)[both]) < 1e-9


def flown(scenario: EllipticScenario, point: Floats, rest: Rest, turns: float) -> tuple[float, float]:
    """Least distance to a face (m) and most thrust (m/s^2) of the manoeuvre, integrated in inertial axes."""
    found = certify_elliptic(scenario, point, rest)
    assert bool(found.go)
    rates, spin = elliptic_rates(scenario, rest), scenario.spin
    start = np.zeros(3)
    start[: len(point)] = point
    if int(found.member) == BRAKE:
        away, duration = _braking(rates, start)
    else:
        away = _turning_in(rates, start, int(found.member), float(found.drop))
        duration = SPANS[int(found.member)] / spin
    path = Manoeuvre(start, away, float(duration), 0.0, 0.0)
    orbit = KeplerOrbit(scenario.mean_motion, scenario.eccentricity, scenario.anomaly)
    e = scenario.eccentricity
    axis = np.array([0.0, 0.0, spin])

    def gravity(t: float, place: Floats) -> Floats:
        """Of a place in inertial axes (LVLH's at t = 0)."""
        turned = float(orbit.turned(np.array(t)))
        cosine = math.cos(scenario.anomaly + turned)
        size = scenario.mean_motion**2 * ((1.0 + e * cosine) / (1.0 - e * e)) ** 3
        up = np.array([math.cos(turned), math.sin(turned), 0.0])
        return size * (3.0 * up * (up @ place) - place)

    def inertial(t: float) -> Floats:
        c, s = math.cos(spin * t), math.sin(spin * t)
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])

    def thrust(t: float) -> Floats:
        q, rate, bend = (each[0] for each in path.motion(np.array([t])))
        pushed = bend + 2.0 * np.cross(axis, rate) + np.cross(axis, np.cross(axis, q))
        turn = inertial(t)
        return np.asarray(turn @ pushed - gravity(t, turn @ q))

    turning = scenario.lvlh_rate if rest is Rest.LVLH else spin
    state = np.concatenate([start, turning * np.array([-start[1], start[0], 0.0])])
    ends = [0.0, float(duration), turns * 2.0 * math.pi / spin]
    least, most = math.inf, 0.0
    faces = corridor_of(SHAPE, 3)
    for begin, end in itertools.pairwise(ends):
        if end <= begin:
            continue
        run = solve_ivp(
            lambda t, x: np.concatenate([x[3:], gravity(t, x[:3]) + thrust(t)]),
            (begin, end),
            state,
            method="DOP853",
            rtol=1e-10,
            atol=1e-9,
            t_eval=np.linspace(begin, end, 120),
        )
        state = run.y[:, -1]
        for t, place in zip(run.t, run.y[:3].T, strict=True):
            room = faces.slack(inertial(t).T @ place) / faces.lengths
            least, most = min(least, float(room.min())), max(most, float(np.linalg.norm(thrust(t))))
    return least, most


@pytest.mark.parametrize("rest", list(Rest))
def test_certified_starts_fly(rest: Rest) -> None:
    random = np.random.Generator(np.random.Philox(4))
    tried = 0
    for k in range(10):
        e = float(random.uniform(0.1, 0.75))
        n = 1.5e-4
        anomaly = float(random.uniform(-math.pi, math.pi))
        spin = float(random.choice([0.004, 0.01, 0.05]))
        scenario = EllipticScenario(spin, n, e, anomaly, 0.01, SHAPE)
        far = 2.0 * 0.01 / spin**2
        points = random.uniform([-1, 0, -0.5], [1, 1, 0.5], (400, 3)) * far
        if k % 2:
            points[:, 2] = 0.0
        found = certify_elliptic(scenario, points, rest)
        certified = np.flatnonzero(found.go)
        if not len(certified):
            continue
        # The farthest is where thrust is scarcest.
        pick = certified[np.linalg.norm(points[certified], axis=1).argmax()]
        least, most = flown(scenario, points[pick], rest, 1.0)
        assert least >= float(found.margin[pick]) - 1e-5
        assert most <= 0.01 * (1.0 + 1e-9)
        tried += 1
    assert tried >= 6


def test_how_eccentric_an_orbit_may_be_depends_on_the_tumble() -> None:
    """No number such as the announced e* = 0.661 is common to all targets."""
    found = []
    for spin in (0.002, 0.005, 0.0524):
        scenario = EllipticScenario(spin, 2e-4, 0.0, 0.0, 0.01, SHAPE)
        point = np.array([0.0, 0.4 * 0.01 / spin**2])
        found.append(largest_eccentricity(scenario, point, Rest.BODY))
    assert found[0] is not None
    assert found[1] is not None
    assert found[2] is not None
    assert found[0] < found[1] < found[2]
    assert found[0] < 0.85
    assert found[2] > 0.9
    at = EllipticScenario(0.002, 2e-4, found[0], 0.0, 0.01, SHAPE)
    beyond = EllipticScenario(0.002, 2e-4, found[0] + 2e-6, 0.0, 0.01, SHAPE)
    point = np.array([0.0, 0.4 * 0.01 / 0.002**2])
    assert bool(certify_elliptic(at, point, Rest.BODY).go)
    assert not bool(certify_elliptic(beyond, point, Rest.BODY).go)
    nothing = np.array([0.0, 1e5])
    assert largest_eccentricity(at, nothing) is None


def test_bad_scenarios_are_named() -> None:
    with pytest.raises(InvalidInput, match="spin"):
        elliptic_rates(EllipticScenario(2e-4, 2e-4, 0.5, 0.0, 0.01, SHAPE), Rest.LVLH)
    with pytest.raises(InvalidInput, match="eccentricity"):
        EllipticScenario(0.01, 2e-4, 0.99, 0.0, 0.01, SHAPE)
    with pytest.raises(InvalidInput, match="points"):
        certify_elliptic(EllipticScenario(0.01, 2e-4, 0.2, 0.0, 0.01, SHAPE), np.array([math.nan, 1.0]))

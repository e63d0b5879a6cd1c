"""`certified` has the same bits however one asks: `safestart.certify` for one start or many, GET, POST, a map."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import safestart as ss
from safestart.closed_form import members
from safestart.closed_form.certified import certify
from safestart.closed_form.certified_point import certify_point, prepare
from safestart.closed_form.rates import rates_of
from safestart.model.scenario import CorridorShape, Floats, Rest, Scenario
from safestart.processes.door import parse, read
from safestart.processes.execute import execute
from safestart.runtime.progress import Context

AROUND = 8
"""Doubles on either side of the border."""


def drawn(seed: int) -> tuple[float, float, float, Rest, CorridorShape, int]:
    """Tumble (deg/s), thrust, mean motion, rest, corridor and dimensions: zeros among them, and random ones."""
    rng = np.random.default_rng(seed)
    shape = CorridorShape() if seed % 3 else CorridorShape(*rng.uniform(0.1, 4.0, 5).tolist())
    return (
        float(rng.choice([0.0, 3.0, rng.uniform(0.0, 10.0), rng.uniform(0.0, 0.05)])),
        float(rng.choice([0.1, 0.05, 10.0 ** rng.uniform(-4.0, -0.5)])),
        float(rng.choice([1.1e-3, 0.0, rng.uniform(0.0, 1.3e-3)])),
        list(Rest)[seed % 2],
        shape,
        2 + seed // 2 % 2,
    )


def scenario_of(case: tuple[float, float, float, Rest, CorridorShape, int]) -> Scenario:
    rate, thrust, motion, _, shape, _ = case
    return Scenario(ss.Target(math.radians(rate), motion), ss.Chaser(thrust), shape)


def around_the_border(scenario: Scenario, rest: Rest, dimensions: int, seed: int, count: int) -> Floats:
    """Starts of ``AROUND`` doubles on either side of where the verdict changes along x, (n, d)."""
    rng = np.random.default_rng(seed)
    shape = scenario.corridor
    place = np.zeros((count, dimensions))
    place[:, 1] = shape.hold_radius + rng.uniform(0.1, 100.0, count)
    if dimensions == 3:
        place[:, 2] = rng.uniform(-1.0, 1.0, count) * shape.z0
    side = rng.choice([-1.0, 1.0], count)
    far = side * (shape.x0 + shape.c_x * (place[:, 1] - shape.hold_radius)) * 1.01
    inside = certify(scenario, place, rest).go
    place, far = place[inside], far[inside]
    near = np.zeros(len(place))
    for _ in range(80):
        middle = 0.5 * (near + far)
        place[:, 0] = middle
        go = certify(scenario, place, rest).go
        near, far = np.where(go, middle, near), np.where(go, far, middle)
    found = []
    for step in range(-AROUND, AROUND + 1):
        x = near.copy()
        for _ in range(abs(step)):
            x = np.nextafter(x, math.copysign(math.inf, step))
        place[:, 0] = x
        found.append(place.copy())
    return np.concatenate(found)


def random_starts(scenario: Scenario, dimensions: int, seed: int, count: int) -> Floats:
    rng = np.random.default_rng(seed)
    shape = scenario.corridor
    y = shape.hold_radius + rng.uniform(-0.5, 120.0, count)
    x = rng.uniform(-1.05, 1.05, count) * (shape.x0 + shape.c_x * np.maximum(y, 0.0))
    z = rng.uniform(-1.0, 1.0, count) * (shape.z0 + shape.c_z * np.maximum(y, 0.0))
    points = np.stack([x, y, z], axis=1)[:, :dimensions]
    points[::7] = np.round(points[::7])  # exact zeros come up
    return points


def asked(case: tuple[float, float, float, Rest, CorridorShape, int]) -> dict[str, Any]:
    rate, thrust, motion, rest, shape, _ = case
    return {
        "omega_t_deg_s": rate,
        "a_max_m_s2": thrust,
        "mean_motion_rad_s": motion,
        "rest": rest.value,
        "method": "certified",
        "corridor": {
            "c_x": shape.c_x,
            "c_z": shape.c_z,
            "x0_m": shape.x0,
            "z0_m": shape.z0,
            "r_h_m": shape.hold_radius,
        },
    }


@pytest.mark.parametrize("seed", range(24))
def test_python_as_the_service(seed: int) -> None:
    """Every rest, plane and space: some 10 000 starts in all, the half of them within 8 doubles of the border."""
    case = drawn(seed)
    scenario, rest, dimensions = scenario_of(case), case[3], case[5]
    points = np.concatenate(
        [
            random_starts(scenario, dimensions, seed, 200),
            around_the_border(scenario, rest, dimensions, seed, 15),
        ]
    )
    found = ss.certify(scenario, points, rest)
    margins = [None if math.isnan(margin) else margin for margin in found.margin_m.tolist()]
    states = [dict(zip(("x_m", "y_m", "z_m"), point, strict=False)) for point in points.tolist()]
    posted = execute("go-no-go", asked(case) | {"states": states}, Context()).document["outputs"]
    assert posted["verdict"] == found.verdict.tolist()
    assert posted["margin_m"] == margins
    flat = asked(case)
    flat |= flat.pop("corridor")
    for k in range(0, len(points), 11):
        got = read({name: str(value) for name, value in {**flat, **states[k]}.items()}).document(Context())
        assert (got["verdict"], got["margin_m"]) == (found.verdict[k], margins[k])
        for one in (points[k], points[k : k + 1]):
            alone = ss.certify(scenario, one, rest)
            assert alone.verdict.tolist() in (found.verdict[k], [found.verdict[k]])
            assert alone.margin_m.tobytes() == found.margin_m[k].tobytes()


@pytest.mark.parametrize("seed", range(24))
def test_all_of_the_certificate_in_plain_floats_as_in_arrays(seed: int) -> None:
    """Also what a verdict does not show: the margin of a start that no manoeuvre helps, the manoeuvre itself."""
    case = drawn(seed)
    rate, thrust, motion, rest, shape, dimensions = case
    scenario = scenario_of(case)
    points = random_starts(scenario, dimensions, seed, 400)
    found = certify(scenario, points, rest)
    given = prepare(math.radians(rate), motion, thrust, shape, rest, dimensions == 3)
    for k, point in enumerate(points.tolist()):
        one = certify_point(given, *point)
        assert one.margin == found.margin[k]
        assert one.go == bool(found.go[k])
        assert one.binding == found.names[int(found.binding[k])]
        if found.margin[k] > -1e-6:  # a manoeuvre leaves this
            assert (one.member, one.drop) == (found.member[k], found.drop[k])


def test_the_start_that_python_called_undecided() -> None:
    scenario = Scenario(ss.Target(0.0, 0.0), ss.Chaser(0.05))
    start = {"x_m": 8.310022756402487, "y_m": 4.37334970611875}
    got = parse(
        {
            **start,
            "omega_t_deg_s": 0,
            "a_max_m_s2": 0.05,
            "mean_motion_rad_s": 0,
            "rest": "body",
            "method": "certified",
        }
    )
    document = got.document(Context())
    found = ss.certify(scenario, [tuple(start.values())], "body")
    assert (document["verdict"], document["margin_m"]) == (found.verdict[0], found.margin_m[0])
    assert document["verdict"] == "GO"


@pytest.mark.parametrize("count", [1, 2, 3, 7, 16, 33, 64, 65, 1000, 40_000])
def test_however_many_others(count: int) -> None:
    """Blocks, vector registers and their remainders round alike."""
    scenario = Scenario.of(3.0, 0.1)
    points = random_starts(scenario, 3, count, count)
    together = certify(scenario, points)
    for k in {0, count // 2, count - 1}:
        alone = certify(scenario, points[k])
        assert alone.margin.tobytes() == together.margin[k].tobytes()


def test_a_term_without_a_coefficient_changes_no_bit() -> None:
    """`Faces` leaves terms of coefficient 0 out; the plain floats add them."""
    rates, faces = rates_of(Scenario.of(3.0, 0.1), Rest.LVLH), members.Faces.of(CorridorShape(), 3)
    place = np.random.default_rng(1).uniform(-100.0, 100.0, (3, 2000))
    room = faces.room(place)
    for k, (x, y, z) in enumerate(place.T.tolist()):
        plain = [
            o - (a * x + b * y + c * z)
            for (a, b, c), (o,) in zip(faces.normals.tolist(), faces.offsets.tolist(), strict=True)
        ]
        assert plain == room[:, k].tolist()
    assert rates.omega > 0.0


@pytest.mark.parametrize("tumble", [5e-324, 1e-200, 1e-160, 1e-14, 1e-11, 1e-9])
def test_a_target_that_hardly_tumbles(tumble: float) -> None:
    """At the end of the braking reach the angle to the stop was 0 over 0: NaN for many starts, an error for one."""
    scenario = Scenario(ss.Target(tumble, 1.1e-3), ss.Chaser(1e-4), CorridorShape())
    rates = rates_of(scenario, Rest.LVLH)
    given = prepare(tumble, 1.1e-3, 1e-4, scenario.corridor, Rest.LVLH, spatial=False)
    range_m = rates.brake_limit / rates.scale
    around = [range_m + k * math.ulp(range_m) for k in range(-200, 201)]
    starts = np.array([(0.0, y) for y in (*around, 2.0 * range_m, 1e5)])
    with np.errstate(all="raise", under="ignore"):
        found = certify(scenario, starts)
    alone = [certify_point(given, *start) for start in starts.tolist()]
    assert found.margin.tolist() == [one.margin for one in alone]
    assert np.isfinite(found.margin).all()
    assert found.go[0]
    assert not found.go[-1]

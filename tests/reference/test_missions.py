"""Questions as missions pose them: asked by the process, proved, and the proofs checked."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

from safestart.processes.execute import execute
from safestart.processes.start_in_space.missions import MISSIONS
from safestart.proofs.checker import check
from safestart.runtime.progress import Context

ENVISAT = {
    # Inertia of the studies for its removal, rounded; its spin in 2013 was 2.67 deg/s against the orbit normal
    # (Kucharski et al., IEEE TGRS 52, 2014). Sun-synchronous, nearly circular at 768 km.
    "inertia_kg_m2": [[17023.0, 397.0, -2171.0], [397.0, 124826.0, 344.0], [-2171.0, 344.0, 129112.0]],
    "orbit": {"semi_major_axis_m": 7.1435e6, "eccentricity": 1.2e-4, "true_anomaly_deg": 90.0},
}
ISS_ORBIT = {"semi_major_axis_m": 6.797e6, "eccentricity": 3e-4}
# A transfer orbit with a perigee at 250 km and an apogee in the geostationary ring.
GTO = {"semi_major_axis_m": 2.4396e7, "eccentricity": 0.7283}


def asked(**question: Any) -> dict[str, Any]:
    """The answer on one start, with its proof checked."""
    found: dict[str, Any] = execute("start-in-space", question | {"proofs": True}, Context()).document[
        "outputs"
    ]
    verified = check(json.loads(json.dumps(found["proof"][0])))
    assert verified.verdict == found["verdict"][0]
    return {"verdict": found["verdict"][0], "margin_m": found["margin_m"][0]}


def cone(half_angle_deg: float, along: tuple[int, float], least: float, frame: str) -> dict[str, Any]:
    """Four sides of a square cone about an axis of the frame, cut by a plane at ``least`` m."""
    axis, sign = along
    slope = math.tan(math.radians(half_angle_deg))
    faces = []
    for name, other, side in (("a", 1, 1.0), ("b", 1, -1.0), ("c", 2, 1.0), ("d", 2, -1.0)):
        normal = [0.0, 0.0, 0.0]
        normal[(axis + other) % 3], normal[axis] = side, -sign * slope
        faces.append({"name": name, "normal": normal, "offset_m": 0.5, "frame": frame})
    plane = [0.0, 0.0, 0.0]
    plane[axis] = -sign
    return {"faces": [*faces, {"name": "plane", "normal": plane, "offset_m": -least, "frame": frame}]}


def test_envisat_spinning_against_the_orbit_normal() -> None:
    """The sign of the spin counts: the orbit turns one way."""
    margins = {}
    for sign in (1.0, -1.0):
        attitude = {
            "kind": "torque_free",
            "inertia_kg_m2": ENVISAT["inertia_kg_m2"],
            "body_rate_deg_s": [0.0, 0.0, sign * 2.67],
        }
        found = asked(
            starts=[{"position_m": [0.0, 30.0, 0.0]}],
            attitude=attitude,
            orbit=ENVISAT["orbit"],
            a_max_m_s2=0.1,
        )
        margins[sign] = found["margin_m"]
    assert margins[-1.0] > 0.0
    assert abs(margins[1.0] - margins[-1.0]) > 0.01


def test_envisat_tumbling_about_three_axes_from_a_moving_start() -> None:
    attitude = {
        "kind": "torque_free",
        "inertia_kg_m2": ENVISAT["inertia_kg_m2"],
        "attitude_wxyz": [0.9, 0.1, -0.2, 0.3],
        "body_rate_deg_s": [0.6, -0.9, -2.4],
    }
    common = {"attitude": attitude, "orbit": ENVISAT["orbit"], "a_max_m_s2": 0.1}
    rest = asked(starts=[{"position_m": [0.0, 25.0, 0.0], "frame": "body"}], **common)
    assert rest["verdict"] == "GO"
    closing = {"position_m": [0.0, 25.0, 0.0], "velocity_m_s": [0.0, -3.0, 0.0], "frame": "body"}
    assert asked(starts=[closing], **common)["verdict"] == "NO_GO"


def test_r_bar_from_below() -> None:
    """Inside 8 degrees below the station, LVLH; a closing speed that thrust cannot take away in time is refused."""
    common = {
        "attitude": {"kind": "spin", "rate_deg_s": 0.0},
        "orbit": ISS_ORBIT,
        "corridor": cone(8.0, (0, -1.0), 10.0, "lvlh"),
        "thrust": {"kind": "box", "a_max_m_s2": [0.02, 0.02, 0.02], "frame": "lvlh"},
        "horizon_s": 120,
    }
    slow = {"position_m": [-150.0, 0.0, 0.0], "velocity_m_s": [0.3, 0.0, 0.0]}
    assert asked(starts=[slow], **common)["verdict"] == "GO"
    fast = {"position_m": [-150.0, 0.0, 0.0], "velocity_m_s": [3.0, 0.0, 0.0]}
    assert asked(starts=[fast], **common)["verdict"] == "NO_GO"


def test_v_bar_cone_of_ten_degrees_with_thrusters() -> None:
    arms = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
    common = {
        "attitude": {"kind": "spin", "rate_deg_s": 0.0},
        "orbit": ISS_ORBIT,
        "corridor": cone(10.0, (1, 1.0), 2.0, "lvlh"),
        "thrust": {"kind": "thrusters", "directions": arms, "a_max_m_s2": [0.03] * 6, "frame": "lvlh"},
    }
    assert asked(starts=[{"position_m": [0.0, 100.0, 0.0]}], **common)["verdict"] == "GO"
    astray = {"position_m": [10.0, 100.0, 0.0], "velocity_m_s": [1.5, 0.0, 0.0]}
    assert asked(starts=[astray], **common)["verdict"] == "NO_GO"


@pytest.mark.parametrize("a_max", [0.05])
def test_a_stage_in_transfer_orbit(a_max: float) -> None:
    """The same start at perigee and at apogee: gravity's gradient is 250 times weaker there."""
    margins = {}
    for anomaly in (0.0, 180.0):
        margins[anomaly] = asked(
            starts=[{"position_m": [0.0, 60.0, 0.0]}],
            attitude={"kind": "spin", "axis": [1, 0, 1], "axis_frame": "inertial", "rate_deg_s": 2.0},
            orbit=GTO | {"true_anomaly_deg": anomaly},
            a_max_m_s2=a_max,
        )["margin_m"]
    assert abs(margins[0.0] - margins[180.0]) > 0.01


def test_a_grapple_on_a_spinning_axis() -> None:
    """Along the axis about which the target spins the corridor only rolls: thrust is hardly needed."""
    common = {
        "attitude": {"kind": "spin", "axis": [0, 1, 0.2], "axis_frame": "inertial", "rate_deg_s": 10.0},
        "orbit": ISS_ORBIT,
        "a_max_m_s2": 0.02,
    }
    along = asked(
        starts=[{"position_m": [0.0, 20.0, 4.0]}],
        corridor={"axis": [0, 1, 0.2], "c_x": 0.5, "c_z": 0.5},
        **common,
    )
    across = asked(
        starts=[{"position_m": [20.0, 0.0, 0.0]}],
        corridor={"axis": [1, 0, 0], "c_x": 0.5, "c_z": 0.5},
        **common,
    )
    assert (along["verdict"], across["verdict"]) == ("GO", "NO_GO")


FIGURES = {
    "envisat": 20.078,
    "envisat-tumbling": 1.000,
    "envisat-tracked": 0.697,
    "envisat-estimated": 18.453,
    "rocket-body": 12.374,
    "r-bar": 3.000,
    "v-bar": 17.265,
    "transfer-perigee": 25.423,
    "transfer-apogee": 23.282,
    "molniya-perigee": 7.118,
    "spinning-axis": 11.125,
    "past-an-array": 0.500,
}
"""Margins, m, as docs/theory/space.md has them."""


@pytest.mark.parametrize("name", FIGURES)
def test_examples_have_the_documented_margins_and_their_flights_keep_them(name: str) -> None:
    assert set(FIGURES) == set(MISSIONS)
    asked = MISSIONS[name] | {"proofs": True, "flights": True}
    found = execute("start-in-space", asked, Context()).document["outputs"]
    assert check(json.loads(json.dumps(found["proof"][0]))).verdict == found["verdict"][0] == "GO"
    assert found["margin_m"][0] == pytest.approx(FIGURES[name], abs=2e-3)
    flight = found["flight"][0]
    assert len(flight["time_s"]) == len(flight["distance_m"]) == len(flight["attitude_wxyz"])
    assert min(map(min, flight["distance_m"])) >= found["margin_m"][0] - 1e-6
    assert flight["lvlh_m"][0] == found["position_m"][0]
    if "hold_m" in asked:
        assert math.dist(flight["body_m"][-1], asked["hold_m"]) < 1e-6
        assert math.hypot(*flight["body_m_s"][-1]) < 1e-6
    else:
        assert flight["time_s"][-1] == asked.get("horizon_s", 60)

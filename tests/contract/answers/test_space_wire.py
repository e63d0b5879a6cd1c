"""Every form of every part of a question in space, as the wire offers it, is taken, answered and proved."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pytest

from safestart.proofs.checker import check
from tests.contract.api.service_client import service

if TYPE_CHECKING:
    from starlette.testclient import TestClient

AXIS = [0.0, math.sqrt(0.5), math.sqrt(0.5)]
BASE: dict[str, Any] = {
    "starts": [{"position_m": [1, 30, 0.5], "velocity_m_s": [0, -0.1, 0], "frame": "body"}],
    "attitude": {"kind": "spin", "axis": [0, 0, 1], "axis_frame": "lvlh", "rate_deg_s": -1, "phase_deg": 0},
    "orbit": {"mean_motion_rad_s": 0.0011},
    "thrust": {"kind": "ball", "a_max_m_s2": 0.1},
    "horizon_s": 20,
    "proofs": True,
    "flights": True,
}
INERTIA = [[120, 2, -1], [2, 100, 3], [-1, 3, 60]]
BOX = [
    {"name": f"{sign}{axis}", "normal": [s * (k == j) for j in range(3)], "offset_m": 90, "frame": frame}
    for sign, s in (("+", 1), ("-", -1))
    for k, (axis, frame) in enumerate((("x", "body"), ("y", "lvlh"), ("z", "body")))
]
FORMS: dict[str, dict[str, Any]] = {
    "as it is": {},
    "start in lvlh": {"starts": [{"position_m": [1, 30, 0.5], "velocity_m_s": [0, 0.1, 0], "frame": "lvlh"}]},
    "spin about an inertial axis": {
        "attitude": {
            "kind": "spin",
            "axis": AXIS,
            "axis_frame": "inertial",
            "rate_deg_s": 1,
            "phase_deg": 20,
        }
    },
    "torque-free, against inertial axes": {
        "attitude": {
            "kind": "torque_free",
            "inertia_kg_m2": INERTIA,
            "attitude_wxyz": [0.9, 0.1, -0.1, 0.2],
            "body_rate_deg_s": [0.5, -0.4, 1],
            "reference": "inertial",
        }
    },
    "torque-free, against lvlh": {
        "attitude": {
            "kind": "torque_free",
            "inertia_kg_m2": INERTIA,
            "attitude_wxyz": [1, 0, 0, 0],
            "body_rate_deg_s": [0.5, -0.4, 1],
            "reference": "lvlh",
        }
    },
    "table, inertial": {
        "attitude": {
            "kind": "table",
            "times_s": [0, 10, 30],
            "attitude_wxyz": [[1, 0, 0, 0], [0.99, 0, 0, 0.1], [0.95, 0, 0.05, 0.3]],
            "reference": "inertial",
        }
    },
    "table, lvlh": {
        "attitude": {
            "kind": "table",
            "times_s": [0, 30],
            "attitude_wxyz": [[1, 0, 0, 0], [0.99, 0, 0, 0.1]],
            "reference": "lvlh",
        }
    },
    "elliptic orbit": {
        "orbit": {"semi_major_axis_m": 24396000, "eccentricity": 0.7283, "true_anomaly_deg": 30}
    },
    "five faces along an axis": {
        "corridor": {"c_x": 1.5, "c_z": 1.5, "x0_m": 2.5, "z0_m": 2.5, "r_h_m": 0.5, "axis": [0, 1, 0]}
    },
    "faces of both frames": {"corridor": {"faces": BOX}},
    "box of thrusts, lvlh": {"thrust": {"kind": "box", "a_max_m_s2": [0.1, 0.1, 0.05], "frame": "lvlh"}},
    "box of thrusts, body": {"thrust": {"kind": "box", "a_max_m_s2": [0.1, 0.1, 0.05], "frame": "body"}},
    "thrusters": {
        "thrust": {
            "kind": "thrusters",
            "directions": [[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]],
            "a_max_m_s2": [0.1, 0.1, 0.1, 0.1],
            "frame": "body",
        }
    },
}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    with service(tmp_path_factory.mktemp("service")) as made:
        yield made


@pytest.mark.parametrize("form", FORMS)
def test_a_form_is_answered_flown_and_proved(client: TestClient, form: str) -> None:
    found = client.post("/go-no-go", json=BASE | FORMS[form])
    assert found.status_code == 200, found.text
    (verdict,), (proof,), (flight,) = (found.json()[name] for name in ("verdict", "proof", "flight"))
    assert verdict == "GO"
    assert check(proof).verdict == "GO"
    assert min(map(min, flight["distance_m"])) >= found.json()["margin_m"][0] - 1e-9


def test_the_targets_turning_is_the_flights_whatever_the_verdict(client: TestClient) -> None:
    """Rates are the change of attitude; a NO_GO has them as well."""
    import numpy as np

    far = (
        BASE | {"starts": [{"position_m": [0, -30, 0], "frame": "body"}]} | FORMS["torque-free, against lvlh"]
    )
    turning = client.post("/go-no-go", json=far).json()["turning"]
    go = client.post("/go-no-go", json=BASE | FORMS["torque-free, against lvlh"]).json()
    assert go["turning"] == turning
    assert turning["time_s"] == [2.0 * k for k in range(11)]
    assert np.allclose(turning["attitude_wxyz"], go["flight"][0]["attitude_wxyz"][::4], atol=1e-12)
    q = np.array(turning["attitude_wxyz"])
    half = np.radians(np.array(turning["rate_deg_s"]))[:-1] + np.radians(np.array(turning["rate_deg_s"]))[1:]
    # Twice the vector part of the turn over an interval is about its mean rate times the interval.
    for one, two, mean in zip(q[:-1], q[1:], half / 2, strict=True):
        two = two if one @ two > 0 else -two
        turn = one[0] * two[1:] - two[0] * one[1:] - np.cross(one[1:], two[1:])
        assert np.allclose(2.0 * turn / 2.0, mean, atol=1e-4)


def test_no_turning_unless_flights_are_asked_for(client: TestClient) -> None:
    assert client.post("/go-no-go", json=BASE | {"flights": False}).json()["turning"] is None

"""Questions of real missions, as inputs of start-in-space; docs/theory/space.md has their sources and answers."""

from __future__ import annotations

from typing import Any

from safestart.papers.envisat import INERTIA_KG_M2 as _ENVISAT

_ENVISAT_ORBIT = {"semi_major_axis_m": 7143500.0, "eccentricity": 0.00012, "true_anomaly_deg": 90.0}
"""Nearly circular at about 770 km."""
_PAPER_ORBIT = {"semi_major_axis_m": 7144800.0, "eccentricity": 0.0, "true_anomaly_deg": 0.0}
_TRANSFER = {"semi_major_axis_m": 24396000.0, "eccentricity": 0.7283}
_MOLNIYA = {"semi_major_axis_m": 26600000.0, "eccentricity": 0.74}


def _cone(axis: int, sign: float, slope: float, port_m: float, least_m: float) -> dict[str, Any]:
    """A square cone in LVLH that opens along an axis, cut at ``least_m``."""
    faces = []
    for name, other, side in (("a", 1, 1.0), ("b", 1, -1.0), ("c", 2, 1.0), ("d", 2, -1.0)):
        normal = [0.0, 0.0, 0.0]
        normal[(axis + other) % 3], normal[axis] = side, -sign * slope
        faces.append({"name": name, "normal": normal, "offset_m": port_m, "frame": "lvlh"})
    plane = [0.0, 0.0, 0.0]
    plane[axis] = -sign
    faces.append({"name": "plane", "normal": plane, "offset_m": -least_m, "frame": "lvlh"})
    return {"faces": faces}


MISSIONS: dict[str, dict[str, Any]] = {
    "envisat": {
        "starts": [{"position_m": [0, 30, 0]}],
        "attitude": {
            "kind": "torque_free",
            "inertia_kg_m2": _ENVISAT,
            "body_rate_deg_s": [0.0, 0.0, -2.67],
        },
        "orbit": _ENVISAT_ORBIT,
        "a_max_m_s2": 0.1,
    },
    # What observers give: attitude to a degree, rate to 0.02 deg/s, moments to 1 %; 1e-4 m/s^2 of what else acts.
    "envisat-estimated": {
        "starts": [{"position_m": [0, 30, 0]}],
        "attitude": {
            "kind": "torque_free",
            "inertia_kg_m2": _ENVISAT,
            "body_rate_deg_s": [0.0, 0.0, -2.67],
        },
        "orbit": _ENVISAT_ORBIT,
        "a_max_m_s2": 0.1,
        "position_half_width_m": 0.5,
        "velocity_half_width_m_s": 0.01,
        "attitude_half_angle_deg": 1,
        "body_rate_half_width_deg_s": 0.02,
        "inertia_half_width": 0.01,
        "disturbance_m_s2": 1e-4,
    },
    "envisat-tumbling": {
        "starts": [{"position_m": [0, 25, 0], "frame": "body"}],
        "attitude": {
            "kind": "torque_free",
            "inertia_kg_m2": _ENVISAT,
            "attitude_wxyz": [0.9, 0.1, -0.2, 0.3],
            "body_rate_deg_s": [0.6, -0.9, -2.4],
        },
        "orbit": _ENVISAT_ORBIT,
        "a_max_m_s2": 0.1,
        "question": "synchronize",
        "hold_m": [0, 5, 0],
        "ball_radius_m": 1.0,
        "within_s": 60,
    },
    # Rebollo et al. (paper 002), Table I: start, rate against LVLH, corridor. Impulses of 0.075 m/s every second there,
    # 0.075 m/s^2 held here. Inertia and orbit are not in the paper.
    "envisat-tracked": {
        "starts": [{"position_m": [1.5, 2.5, 1.5], "velocity_m_s": [0, 0, 0], "frame": "lvlh"}],
        "attitude": {
            "kind": "torque_free",
            "inertia_kg_m2": _ENVISAT,
            "body_rate_deg_s": [0.0, 3.53, 3.53],
            "reference": "lvlh",
        },
        "orbit": _PAPER_ORBIT,
        "corridor": {"c_x": 1.0, "c_z": 1.0, "x0_m": 0.1, "z0_m": 0.1, "r_h_m": 0.0},
        "thrust": {"kind": "box", "a_max_m_s2": [0.075, 0.075, 0.075], "frame": "lvlh"},
    },
    # A CZ-3B third stage turns once in 117.724 s (Zhao et al., Adv. Space Res. 65, 2020); here in a flat spin.
    # Inertia of a thin-walled cylinder along y of the stage's size, 12.4 m by 3 m (Wikipedia, Long March 3B: 12.375 m,
    # 3.00 m). Assumed: 2740 kg, of which no answer depends (ratios of moments count), and the way to 21 500 km.
    "rocket-body": {
        "starts": [{"position_m": [2, 25, 1], "velocity_m_s": [0, 0, 0], "frame": "body"}],
        "attitude": {
            "kind": "torque_free",
            "inertia_kg_m2": [[38190.0, 0, 0], [0, 6165.0, 0], [0, 0, 38190.0]],
            "body_rate_deg_s": [0.0, 0.0, 3.058],
        },
        "orbit": {"semi_major_axis_m": 17278000.0, "eccentricity": 0.6135, "true_anomaly_deg": 180.0},
        "corridor": {"axis": [0, 1, 0], "c_x": 1.0, "c_z": 1.0, "x0_m": 1.5, "z0_m": 1.5, "r_h_m": 7.0},
        "a_max_m_s2": 0.1,
    },
    "r-bar": {
        "starts": [{"position_m": [-150, 0, 0], "velocity_m_s": [0.3, 0, 0]}],
        "attitude": {"kind": "spin", "rate_deg_s": 0.0},
        "orbit": {"semi_major_axis_m": 6797000.0, "eccentricity": 0.0003},
        "corridor": _cone(0, -1.0, 0.14054, 0.5, 10.0),
        "thrust": {"kind": "box", "a_max_m_s2": [0.02, 0.02, 0.02], "frame": "lvlh"},
        "speed_limit_m_s": 0.6,
        "horizon_s": 120,
    },
    "v-bar": {
        "starts": [{"position_m": [0, 100, 0]}],
        "attitude": {"kind": "spin", "rate_deg_s": 0.0},
        "orbit": {"semi_major_axis_m": 6797000.0, "eccentricity": 0.0003},
        "corridor": _cone(1, 1.0, 0.17633, 0.5, 2.0),
        "thrust": {
            "kind": "thrusters",
            "directions": [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]],
            "a_max_m_s2": [0.03, 0.03, 0.03, 0.03, 0.03, 0.03],
        },
        "position_half_width_m": 0.5,
        "velocity_half_width_m_s": 0.01,
    },
    "transfer-perigee": {
        "starts": [{"position_m": [0, 60, 0]}],
        "attitude": {"kind": "spin", "axis": [1, 0, 1], "axis_frame": "inertial", "rate_deg_s": 2.0},
        "orbit": _TRANSFER | {"true_anomaly_deg": 0.0},
        "a_max_m_s2": 0.05,
    },
    "transfer-apogee": {
        "starts": [{"position_m": [0, 60, 0]}],
        "attitude": {"kind": "spin", "axis": [1, 0, 1], "axis_frame": "inertial", "rate_deg_s": 2.0},
        "orbit": _TRANSFER | {"true_anomaly_deg": 180.0},
        "a_max_m_s2": 0.05,
    },
    "molniya-perigee": {
        "starts": [{"position_m": [0, 40, 0], "velocity_m_s": [0.2, 0, 0]}],
        "attitude": {"kind": "spin", "axis": [1, 0, 1], "axis_frame": "inertial", "rate_deg_s": -3.0},
        "orbit": _MOLNIYA | {"true_anomaly_deg": 0.0},
        "a_max_m_s2": 0.05,
    },
    "spinning-axis": {
        "starts": [{"position_m": [0, 20, 4]}],
        "attitude": {"kind": "spin", "axis": [0, 1, 0.2], "axis_frame": "inertial", "rate_deg_s": 10.0},
        "orbit": {"semi_major_axis_m": 7180000.0, "eccentricity": 0.0},
        "corridor": {"axis": [0, 1, 0.2], "c_x": 0.5, "c_z": 0.5},
        "a_max_m_s2": 0.02,
    },
    "past-an-array": {
        "starts": [{"position_m": [0, 60, 0]}],
        "attitude": {"kind": "spin", "rate_deg_s": 0.0},
        "orbit": {"semi_major_axis_m": 6797000.0, "eccentricity": 0.0003},
        "corridor": _cone(1, 1.0, 0.3, 0.5, 2.0),
        "a_max_m_s2": 0.03,
        "question": "synchronize",
        "hold_m": [0, 10, 0],
        "keep_outs": [
            {"name": "array", "centre_m": [4, 35, 0], "half_widths_m": [4.5, 1, 10], "frame": "lvlh"}
        ],
        "field_of_view": {"axis": [0, -1, 0], "half_angle_deg": 15},
        "plume": {"half_angle_deg": 20, "range_m": 40},
    },
}

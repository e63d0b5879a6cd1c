"""Questions that take a second or so each: CI asks them. Names are ``process/what``."""

from __future__ import annotations

from typing import Any

Inputs = dict[str, Any]
POINT: Inputs = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1}
STARTS = [{"x_m": x, "y_m": y} for x, y in ((5, 40), (-20, 55), (0, 90), (12, 60), (80, 30), (0, 0.6))]
SOLID = [{"x_m": 5, "y_m": 40, "z_m": z} for z in (0, 8, -40)]
SLIVER: Inputs = {"omega_t_deg_s": 2, "a_max_m_s2": 0.05, "states": [{"x_m": 9.364, "y_m": 81.044}]}
SYNC: Inputs = {
    "omega_t_deg_s": 2,
    "a_max_m_s2": 0.05,
    "states": [{"x_m": 5, "y_m": 40}, {"x_m": 20, "y_m": 78}],
    "question": "synchronize",
    "method": "exact",
    "proofs": True,
}
CORRIDOR = {"c_x": 1.0, "c_z": 0.8, "x0_m": 4.0, "z0_m": 3.0, "r_h_m": 2.0}
MANY = [{"x_m": 1.7 * k - 90, "y_m": 10 + (7.3 * k) % 120} for k in range(150)]


def starts_asked(**more: Any) -> Inputs:
    return {**POINT, "states": STARTS, **more}


def proved(**more: Any) -> Inputs:
    return starts_asked(**{"method": "exact", "proofs": True, **more})


def family(**more: Any) -> Inputs:
    starts = [{"x_m": 5, "y_m": 40}, {"x_m": 12, "y_m": 60}, {"x_m": 0, "y_m": 90}]
    return {**POINT, "states": starts, "method": "exact", "proofs": True, **more}


def engines(*names: str, **more: Any) -> Inputs:
    small = {"nx": 15, "ny": 13, "y_max_m": 80}
    return {**POINT, "grid": small, "engines": list(names), "horizon_s": 20, **more}


def level_set(accuracy: str, **more: Any) -> Inputs:
    options = {"accuracy": accuracy, "nodes_xy": 21, "nodes_v": 9, **more}
    return engines("analytical", "exact", "hamilton_jacobi", horizon_s=6, hamilton_jacobi=options)


SPACE: Inputs = {
    "starts": [
        {"position_m": [2, 25, 1], "velocity_m_s": [0, -0.1, 0], "frame": "body"},
        {"position_m": [5, 40, 8], "velocity_m_s": [2, 1, 0]},
    ],
    "attitude": {
        "kind": "torque_free",
        "inertia_kg_m2": [[17023, 397, -2171], [397, 124826, 344], [-2171, 344, 129112]],
        "body_rate_deg_s": [0.6, -0.9, -2.4],
    },
    "proofs": True,
}
TETRAHEDRON = {
    "kind": "thrusters",
    "directions": [[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]],
    "a_max_m_s2": [0.1, 0.1, 0.1, 0.1],
    "frame": "body",
}

NO_LEVEL_SET = ("analytical", "exact", "backward", "forward", "monte_carlo")

QUICK: dict[str, Inputs | tuple[Inputs, ...]] = {
    "start-in-space/torque-free": {**SPACE, "a_max_m_s2": 0.1},
    "start-in-space/elliptic": {
        **SPACE,
        "orbit": {"semi_major_axis_m": 24396000, "eccentricity": 0.7283, "true_anomaly_deg": 20},
        "thrust": TETRAHEDRON,
    },
    "start-in-space/not-known": {
        **SPACE,
        "a_max_m_s2": 0.1,
        "position_half_width_m": 0.2,
        "attitude_half_angle_deg": 1,
        "body_rate_half_width_deg_s": 0.01,
        "inertia_half_width": 0.01,
        "disturbance_m_s2": 1e-4,
    },
    "go-no-go/paper": starts_asked(method="paper"),
    "go-no-go/paper-body": starts_asked(method="paper", rest="body"),
    "go-no-go/paper-solid": {**POINT, "states": SOLID, "method": "paper"},
    "go-no-go/paper-corridor": starts_asked(method="paper", corridor=CORRIDOR, mean_motion_rad_s=0.0),
    "go-no-go/paper-still": {"omega_t_deg_s": 0, "a_max_m_s2": 0.01, "states": STARTS, "method": "paper"},
    "go-no-go/paper-sliver": {**SLIVER, "method": "paper"},
    "go-no-go/paper-by-its-old-name": starts_asked(method="closed_form"),
    "go-no-go/certified": starts_asked(method="certified"),
    "go-no-go/certified-body": starts_asked(method="certified", rest="body"),
    "go-no-go/certified-solid": {**POINT, "states": SOLID, "method": "certified"},
    "go-no-go/certified-corridor": starts_asked(method="certified", corridor=CORRIDOR, mean_motion_rad_s=0.0),
    "go-no-go/certified-still": {
        "omega_t_deg_s": 0,
        "a_max_m_s2": 0.01,
        "states": STARTS,
        "method": "certified",
    },
    "go-no-go/default": starts_asked(),
    "go-no-go/default-sliver": SLIVER,
    "go-no-go/exact": proved(),
    "go-no-go/exact-body": proved(rest="body"),
    "go-no-go/exact-solid": {**POINT, "states": SOLID, "method": "exact", "proofs": True},
    "go-no-go/exact-corridor": proved(corridor=CORRIDOR, mean_motion_rad_s=0.0, horizon_s=30),
    "go-no-go/exact-limits": proved(speed_limit_m_s=2.0, keep_out_m=0.4),
    "go-no-go/exact-sliver": {**SLIVER, "method": "exact", "proofs": True},
    "go-no-go/auto": proved(method="auto"),
    "go-no-go/auto-atlas": {**POINT, "states": MANY, "method": "auto"},
    "go-no-go/auto-atlas-known": ({**POINT, "states": MANY, "method": "auto"}, proved(method="auto")),
    "go-no-go/disturbed": proved(disturbance_m_s2=0.002, start_error_m=0.3, start_error_m_s=0.01),
    "go-no-go/synchronize": SYNC,
    "go-no-go/synchronize-held": {
        **SYNC,
        "hold_x_m": 2.0,
        "hold_y_m": 6.0,
        "ball_radius_m": 1.0,
        "within_s": 120,
    },
    "go-no-go/family-common": family(omega_t_half_width_deg_s=0.03, position_half_width_m=0.5),
    "go-no-go/family-per-corner": family(
        witness="per_corner",
        position_half_width_m=1.0,
        velocity_half_width_m_s=0.02,
        a_max_half_width_m_s2=0.001,
    ),
    "certificate/body": {**POINT, "rest": "body", "grid": {"nx": 15, "ny": 13, "y_max_m": 80}},
    "certificate/corridor": {**POINT, "corridor": CORRIDOR, "grid": {"nx": 15, "ny": 13, "y_max_m": 80}},
    "safe-region/short": {"omega_t_deg_s": 2, "a_max_m_s2": 0.05, "horizon_s": 20, "y_max_m": 100},
    "thrust-map/body": {"omega_t_deg_s": [0, 2], "a_max_m_s2": [0.05, 0.1], "rest": "body"},
    "flight/synchronize": {
        "omega_t_deg_s": 2,
        "a_max_m_s2": 0.05,
        "start": {"x_m": 5, "y_m": 40},
        "question": "synchronize",
    },
    "flight/solid-no-go": {**POINT, "start": {"x_m": 5, "y_m": 90, "z_m": 20}},
    "flight/body": {**POINT, "start": {"x_m": 3, "y_m": 30}, "rest": "body", "horizon_s": 20},
    "coverage/small": {"omega_t_deg_s": [0, 2], "a_max_m_s2": [0.05], "grid": {"nx": 41, "ny": 31}},
    "atlas/small": {**POINT, "horizon_s": 20, "gap": 0.02, "grid": {"nx": 11, "ny": 11, "y_max_m": 100}},
    "benchmark/engines": engines(*NO_LEVEL_SET),
    "benchmark/body": engines(*NO_LEVEL_SET, rest="body", seed=5),
    "benchmark/tube": engines(*NO_LEVEL_SET, set="tube"),
    "benchmark/level-set": level_set("very_high"),
    "benchmark/level-set-body": level_set("low", frame="body"),
    "sweep/small": {"cases_per_cell": 1, "omega_t_deg_s": [2], "a_max_m_s2": [0.05], "seed": 3},
    "trade-study/small": {
        "omega_t_deg_s": [1, 3],
        "a_max_m_s2": [0.1],
        "grid": {"nx": 9, "ny": 9},
        "horizon_s": 20,
    },
    "passive-safety/short": {
        "abort_windows_min": [[120, 125]],
        "horizon_min": 240,
        "critical_abort": False,
    },
    "passive-abort/earth-zones": {
        "model": "earth",
        "eccentricity": 0.02,
        "start": {"position_m": [0, 260, 0], "velocity_m_s": [0, 0, 0]},
        "burns": [{"time_s": 0, "impulse_m_s": [0.05, 0, 0.01], "duration_s": 60}],
        "zones": [{"kind": "box", "centre_m": [4, -20, 3], "half_m": [8, 30, 5]}],
        "keep_out_m": 10,
        "abort_orbits": 0.5,
        "failures": {"late_s": 20, "partial": True, "stuck_s": 2},
    },
    "safe-abort-map/small": {"arc": {"rings": 1, "angles": 6}, "windows": 6},
}

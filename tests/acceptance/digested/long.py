"""Questions that are asked by hand: options that take longer, and those that few ask for."""

from __future__ import annotations

from tests.acceptance.digested.quick import (
    CORRIDOR,
    NO_LEVEL_SET,
    POINT,
    SYNC,
    Inputs,
    family,
    level_set,
    proved,
)

ALL_ENGINES = (*NO_LEVEL_SET, "hamilton_jacobi")

TRUTH = {
    "navigation_position_sigma_m": 0.1,
    "navigation_velocity_sigma_m_s": 0.005,
    "minimum_impulse_m_s": 0.002,
}
ERRORS = {**TRUTH, "thrust_magnitude_sigma": 0.02, "thrust_direction_sigma_deg": 1.0}
FEW = {"cases_per_cell": 3, "omega_t_deg_s": [1, 3], "a_max_m_s2": [0.05, 0.1]}
ABORTS: Inputs = {"abort_windows_min": [[120, 125], [0, 240]], "box_half_width_m": 0.2}
GAME: Inputs = {
    "encounters": 20,
    "supervised": 5,
    "grid": {"nodes_position": 15, "nodes_speed": 9},
    "horizon_s": 30,
}

LONG: dict[str, Inputs | tuple[Inputs, ...]] = {
    "go-no-go/family-all": family(
        omega_t_half_width_deg_s=0.02,
        a_max_half_width_m_s2=0.001,
        mean_motion_half_width_rad_s=2e-5,
        position_half_width_m=0.3,
        velocity_half_width_m_s=0.01,
    ),
    "go-no-go/family-body": family(rest="body", omega_t_half_width_deg_s=0.05, velocity_half_width_m_s=0.01),
    "go-no-go/family-solid": {
        **family(a_max_half_width_m_s2=0.002, mean_motion_half_width_rad_s=5e-5, position_half_width_m=0.2),
        "states": [{"x_m": 5, "y_m": 40, "z_m": 8}, {"x_m": 0, "y_m": 90, "z_m": 5}],
    },
    "go-no-go/family-wide": family(
        omega_t_half_width_deg_s=1.0, position_half_width_m=5.0, witness="per_corner"
    ),
    "go-no-go/family-auto": family(method="auto", omega_t_half_width_deg_s=0.5, a_max_half_width_m_s2=0.02),
    "go-no-go/disturbed-body": proved(rest="body", disturbance_m_s2=0.001),
    "go-no-go/disturbed-too-much": proved(disturbance_m_s2=0.09),
    "go-no-go/synchronize-body-fast": {**SYNC, "rest": "body", "speed_limit_m_s": 1.5, "rest_speed_m_s": 0.1},
    "go-no-go/synchronize-solid": {**SYNC, "states": [{"x_m": 5, "y_m": 40, "z_m": 4}], "hold_z_m": 0.3},
    "safe-region/none": {"omega_t_deg_s": 8, "a_max_m_s2": 0.002},
    "atlas/none": {"omega_t_deg_s": 8, "a_max_m_s2": 0.002, "grid": {"nx": 9, "ny": 9}},
    "coverage/corridor": {"corridor": CORRIDOR, "grid": {"nx": 51, "ny": 41}, "mean_motion_rad_s": 0.0},
    "benchmark/still": {**level_set("low"), "omega_t_deg_s": 0, "engines": list(ALL_ENGINES)},
    "benchmark/hj-reachability": level_set("low", solver="hj_reachability"),
    "benchmark/hj-reachability-very-high": level_set("very_high", solver="hj_reachability", frame="body"),
    "benchmark/level-set-medium": level_set("medium"),
    "benchmark/level-set-high": level_set("high", frame="lvlh"),
    "benchmark/level-set-tube-body": {**level_set("low"), "rest": "body", "set": "tube"},
    "sweep/noise": {**FEW, "controllers": ["filter", "filter_fine", "sequence"], "truth": ERRORS},
    "sweep/paper-nodes": {**FEW, "controllers": ["filter"], "preset": "paper", "truth": {"check": "nodes"}},
    "sweep/substeps": {**FEW, "controllers": ["filter"], "truth": {"check": "substeps"}},
    "sweep/filter": {
        **FEW,
        "controllers": ["filter", "filter_fine"],
        "filter": {
            "closing_factor": 0.6,
            "braking_share": 0.25,
            "move_weight": 0.2,
            "corridor_margin_m": 0.1,
        },
    },
    "sweep/no-disk": {**FEW, "controllers": ["filter"], "filter": {"disk_projection": False}},
    "sweep/two-body": {
        **FEW,
        "controllers": ["filter", "sequence"],
        "truth": {"model": "two_body_j2", **ERRORS},
    },
    "sweep/monte-carlo": {
        "distribution": "monte_carlo",
        "cases": 200,
        "controllers": ["filter"],
        "exact_cases": 50,
    },
    "sweep/latin-hypercube": {
        "distribution": "latin_hypercube",
        "cases": 60,
        "corridor": CORRIDOR,
        "seed": 11,
    },
    "sweep/false-go": {
        "omega_t_deg_s": [2],
        "a_max_m_s2": [0.05],
        "r0_m": [40, 81.6],
        "cases_per_cell": 300,
        "controllers": ["filter"],
        "worst": 2,
    },
    "trade-study/paper": {
        "omega_t_deg_s": [2],
        "a_max_m_s2": [0.05, 0.2],
        "preset": "paper",
        "grid": {"nx": 15, "ny": 15},
    },
    "passive-safety/nonlinear": {**ABORTS, "model": "nonlinear"},
    "passive-safety/circle": {**ABORTS, "guard": "circle"},
    "passive-safety/nonlinear-circle": {
        **ABORTS,
        "model": "nonlinear",
        "guard": "circle",
        "critical_abort": False,
    },
    "passive-safety/bryson": {
        **ABORTS,
        "gains": "bryson",
        "mode_1": {"x_m": 900, "y_m": 900, "vx_m_s": 0.3, "vy_m_s": 0.3, "thrust_n": 8},
    },
    "passive-safety/no-failure": {"abort_windows_min": [], "critical_abort": False},
    "safe-abort-map/grid": {"starts": "grid", "grid": {"nx": 5, "ny": 5}, "windows": 12},
    "safe-abort-map/nonlinear": {"arc": {"rings": 1, "angles": 5}, "windows": 6, "model": "nonlinear"},
    "collision-avoidance/small": {
        **GAME,
        "states": [
            *([300, 50, -3, -1], [110, 5, -4, 0], [400, -60, -5, 1], [90, 0, 0, 0]),
            *(
                [150, 0, 0, 0, 0, 0],
                [130, 20, 40, -4, -1, -1],
                [200, 0, 300, 0, 0, -2],
                [105, 0, 5, -3, 0, 0],
            ),
        ],
    },
    "collision-avoidance/disk-fuel": {
        **GAME,
        "shape": "disk",
        "fuel_price_s": 5.0,
        "grid": {"nodes_position": 11, "nodes_speed": 7, "accuracy": "low"},
    },
    "collision-avoidance/paper": {**GAME, "players": "paper"},
    "collision-avoidance/sized-box": {
        **GAME,
        "grid": {"nodes_position": 11, "nodes_speed": 7, "box": None, "accuracy": "medium"},
    },
    "inclusion-chain/no-level-sets": {
        **POINT,
        "sets": ["tube", "analytical_tube", "analytical", "synchronize", "stay", "exact_position"],
        "grid": {"nx": 15, "ny": 15},
        "containment_up_to_s": 100,
    },
    "inclusion-chain/disturbed": {
        **POINT,
        "sets": ["tube", "analytical_tube", "analytical", "stay"],
        "grid": {"nx": 11, "ny": 11},
        "disturbance_m_s2": 0.09,
        "containment_up_to_s": 0,
    },
    "inclusion-chain/hj-reachability": {
        **POINT,
        "sets": ["analytical", "hj_match", "hj_position"],
        "grid": {"nx": 11, "ny": 11, "y_max_m": 80},
        "horizon_s": 6,
        "match_m_s": 2.0,
        "containment_up_to_s": 0,
        "hamilton_jacobi": {"solver": "hj_reachability", "nodes_xy": 21, "nodes_v": 9, "accuracy": "low"},
    },
}

"""What is asked for the digests: every process on its example, and each option once on small inputs.

Names are ``process/what``. ``QUICK`` ones take a second or so each and run in CI, the others by hand.
"""

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
MANY = [{"x_m": 1.7 * k - 90, "y_m": 10 + (7.3 * k) % 120} for k in range(110)]


def _asked(**more: Any) -> Inputs:
    return {**POINT, "states": STARTS, **more}


def _proved(**more: Any) -> Inputs:
    return _asked(**{"method": "exact", "proofs": True, **more})


def _family(**more: Any) -> Inputs:
    starts = [{"x_m": 5, "y_m": 40}, {"x_m": 12, "y_m": 60}, {"x_m": 0, "y_m": 90}]
    return {**POINT, "states": starts, "method": "exact", "proofs": True, **more}


def _engines(*names: str, **more: Any) -> Inputs:
    small = {"nx": 15, "ny": 13, "y_max_m": 80}
    return {**POINT, "grid": small, "engines": list(names), "horizon_s": 20, **more}


def _level_set(accuracy: str, **more: Any) -> Inputs:
    options = {"accuracy": accuracy, "nodes_xy": 21, "nodes_v": 9, **more}
    return _engines("analytical", "exact", "hamilton_jacobi", horizon_s=6, hamilton_jacobi=options)


NO_LEVEL_SET = ("analytical", "exact", "backward", "forward", "monte_carlo")

QUICK: dict[str, Inputs | tuple[Inputs, ...]] = {
    "go-no-go/closed-form": _asked(),
    "go-no-go/closed-form-body": _asked(rest="body"),
    "go-no-go/closed-form-solid": {**POINT, "states": SOLID},
    "go-no-go/closed-form-corridor": _asked(corridor=CORRIDOR, mean_motion_rad_s=0.0),
    "go-no-go/closed-form-still": {"omega_t_deg_s": 0, "a_max_m_s2": 0.01, "states": STARTS},
    "go-no-go/closed-form-sliver": SLIVER,
    "go-no-go/exact": _proved(),
    "go-no-go/exact-body": _proved(rest="body"),
    "go-no-go/exact-solid": {**POINT, "states": SOLID, "method": "exact", "proofs": True},
    "go-no-go/exact-corridor": _proved(corridor=CORRIDOR, mean_motion_rad_s=0.0, horizon_s=30),
    "go-no-go/exact-limits": _proved(speed_limit_m_s=2.0, keep_out_m=0.4),
    "go-no-go/exact-sliver": {**SLIVER, "method": "exact", "proofs": True},
    "go-no-go/auto": _proved(method="auto"),
    "go-no-go/auto-atlas": {**POINT, "states": MANY, "method": "auto"},
    "go-no-go/auto-atlas-known": ({**POINT, "states": MANY, "method": "auto"}, _proved(method="auto")),
    "go-no-go/disturbed": _proved(disturbance_m_s2=0.002, start_error_m=0.3, start_error_m_s=0.01),
    "go-no-go/synchronize": SYNC,
    "go-no-go/synchronize-held": {
        **SYNC,
        "hold_x_m": 2.0,
        "hold_y_m": 6.0,
        "ball_radius_m": 1.0,
        "within_s": 120,
    },
    "go-no-go/family-common": _family(omega_t_half_width_deg_s=0.03, position_half_width_m=0.5),
    "go-no-go/family-per-corner": _family(
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
    "benchmark/engines": _engines(*NO_LEVEL_SET),
    "benchmark/body": _engines(*NO_LEVEL_SET, rest="body", seed=5),
    "benchmark/tube": _engines(*NO_LEVEL_SET, set="tube"),
    "benchmark/level-set": _level_set("very_high"),
    "benchmark/level-set-body": _level_set("low", frame="body"),
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
    "safe-abort-map/small": {"arc": {"rings": 1, "angles": 6}, "windows": 6},
}

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
    "go-no-go/family-all": _family(
        omega_t_half_width_deg_s=0.02,
        a_max_half_width_m_s2=0.001,
        mean_motion_half_width_rad_s=2e-5,
        position_half_width_m=0.3,
        velocity_half_width_m_s=0.01,
    ),
    "benchmark/hj-reachability": _level_set("low", solver="hj_reachability"),
    "benchmark/hj-reachability-very-high": _level_set("very_high", solver="hj_reachability", frame="body"),
    "benchmark/level-set-medium": _level_set("medium"),
    "benchmark/level-set-high": _level_set("high", frame="lvlh"),
    "benchmark/level-set-tube-body": {**_level_set("low"), "rest": "body", "set": "tube"},
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
    "safe-abort-map/grid": {"starts": "grid", "grid": {"nx": 6, "ny": 6}, "windows": 12},
    "safe-abort-map/nonlinear": {"arc": {"rings": 1, "angles": 5}, "windows": 6, "model": "nonlinear"},
    "collision-avoidance/small": {
        **GAME,
        "states": [[300, 50, -3, -1], [150, 0, 0, 0, 0, 0], [110, 5, -4, 0]],
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
}

_START = ("--omega-t-deg-s", "3", "--a-max-m-s2", "0.1", "--x-m", "5", "--y-m", "40")

QUICK_COMMANDS: dict[str, tuple[tuple[str, ...], ...]] = {
    "command/go-no-go": (("go-no-go", *_START, "--json"),),
    "command/proof": (
        ("go-no-go", *_START, "--method", "exact", "--proof", "proof.json", "--json"),
        ("verify", "proof.json", "--json"),
    ),
    "command/run": (("run", "thrust-map", "--json"),),
    "reproduce/table1": (("reproduce", "table1", "--json"),),
}
LONG_COMMANDS: dict[str, tuple[tuple[str, ...], ...]] = {
    "reproduce/table2": (("reproduce", "table2", "--json"),),
    "reproduce/table3": (("reproduce", "table3", "--json"),),
    "reproduce/chain": (("reproduce", "chain", "--json"),),
    "reproduce/chain-no-level-sets": (("reproduce", "chain", "--no-level-sets", "--rate", "4", "--json"),),
    "reproduce/passive-safety": (("reproduce", "passive-safety", "--json"),),
    "reproduce/passive-safety-nonlinear": (
        ("reproduce", "passive-safety", "--model", "nonlinear", "--guard", "circle", "--json"),
    ),
    "reproduce/collision-avoidance": (("reproduce", "collision-avoidance", "--json"),),
    "reproduce/all": (("reproduce", "all", "--json"),),
}
COMMANDS = QUICK_COMMANDS | LONG_COMMANDS
"""Command lines, run one after the other in one empty folder."""

QUERY = {**POINT, "x_m": 5, "y_m": 40}
AT_ONCE: dict[str, tuple[tuple[str, str, Inputs], ...]] = {
    "service/at-once/go-no-go": (
        ("GET", "/go-no-go", QUERY),
        ("GET", "/go-no-go", {**QUERY, "rest": "body", "z_m": 4, "c_x": 1.2, "r_h_m": 1}),
        ("GET", "/go-no-go", {**QUERY, "method": "exact", "proofs": True}),
        ("GET", "/go-no-go", {**QUERY, "omega_t_deg_s": 0}),
        ("GET", "/go-no-go/proof", {**QUERY, "method": "exact"}),
        ("POST", "/go-no-go", _asked()),
        ("POST", "/go-no-go", _family(omega_t_half_width_deg_s=0.02)),
    ),
    "service/at-once/certificates": (("POST", "/certificates", {**POINT, "grid": {"nx": 9, "ny": 7}}),),
    "service/at-once/execution": (
        ("POST", "/processes/thrust-map/execution", {"inputs": {"omega_t_deg_s": [2]}}),
        (
            "POST",
            "/processes/go-no-go/execution",
            {"inputs": _asked(), "outputs": {"verdict": {}, "margin_m": {}}},
        ),
        ("POST", "/processes/benchmark/execution", {"inputs": {**POINT, "engines": []}}),
    ),
}
"""Calls that the service answers without a queue, and one that it refuses."""
SERVED = ("go-no-go/exact", "go-no-go/family-common", "go-no-go/synchronize", "sweep/small")
"""Questions asked as jobs besides the examples."""

QUICK_EXAMPLES = ("go-no-go", "certificate", "safe-region", "thrust-map", "flight", "coverage", "atlas")
"""Processes whose example takes a second or so."""


def quick_names() -> list[str]:
    """The questions that CI asks."""
    return [f"{process_id}/example" for process_id in QUICK_EXAMPLES] + list(QUICK) + list(QUICK_COMMANDS)


def names() -> list[str]:
    """Every question, quick ones first."""
    from safestart.processes.registry import PROCESS_IDS

    others = [f"{process_id}/example" for process_id in PROCESS_IDS if process_id not in QUICK_EXAMPLES]
    return quick_names() + others + list(LONG) + list(LONG_COMMANDS) + served_names()


def served_names() -> list[str]:
    """The questions that are asked over HTTP."""
    from safestart.processes.registry import PROCESS_IDS

    jobs = [f"{process_id}/example" for process_id in PROCESS_IDS] + list(SERVED)
    return list(AT_ONCE) + [f"service/{name}" for name in jobs]


def asked(name: str) -> tuple[str, tuple[Inputs, ...]]:
    """Process and inputs, one after the other, of a question; ``example`` is what the process itself declares."""
    from safestart.processes.registry import process

    process_id, _, what = name.partition("/")
    inputs = dict(process(process_id).example) if what == "example" else (QUICK | LONG)[name]
    return process_id, inputs if isinstance(inputs, tuple) else (inputs,)

"""The questions on the command line and over HTTP."""

from __future__ import annotations

from tests.acceptance.digested.quick import POINT, Inputs, family, starts_asked

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
    "reproduce/tracking-mpc": (("reproduce", "tracking-mpc", "--json"),),
    "reproduce/hopping": (("reproduce", "hopping", "--json"),),
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
        ("POST", "/go-no-go", starts_asked()),
        ("POST", "/go-no-go", family(omega_t_half_width_deg_s=0.02)),
    ),
    "service/at-once/certificates": (("POST", "/certificates", {**POINT, "grid": {"nx": 9, "ny": 7}}),),
    "service/at-once/execution": (
        ("POST", "/processes/thrust-map/execution", {"inputs": {"omega_t_deg_s": [2]}}),
        (
            "POST",
            "/processes/go-no-go/execution",
            {"inputs": starts_asked(), "outputs": {"verdict": {}, "margin_m": {}}},
        ),
        ("POST", "/processes/benchmark/execution", {"inputs": {**POINT, "engines": []}}),
    ),
}
"""Calls that the service answers without a queue, and one that it refuses."""
SERVED = ("go-no-go/exact", "go-no-go/family-common", "go-no-go/synchronize", "sweep/small")
"""Questions asked as jobs besides the examples."""

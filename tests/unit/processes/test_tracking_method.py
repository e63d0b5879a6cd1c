"""Go-no-go by the tracking MPC: GO with documents that the checker verifies, never where nothing can stay."""

import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.processes.execute import execute
from safestart.proofs import checker

PLANAR = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "method": "tracking"}
ENVISAT = [[17023.3, 397.1, -2171.4], [397.1, 124825.7, 344.2], [-2171.4, 344.2, 129112.2]]
SPACE = {
    "attitude": {"kind": "torque_free", "inertia_kg_m2": ENVISAT, "body_rate_deg_s": [0, 3.53, 3.53]},
    "orbit": {"mean_motion_rad_s": 0.00104536},
    "method": "tracking",
    "corridor": {"x0_m": 0.5, "z0_m": 0.5, "c_x": 1, "c_z": 1, "r_h_m": 1},
}


@pytest.mark.parametrize("question", ["stay", "synchronize"])
def test_a_go_is_proved_and_certified(question):
    starts = [{"x_m": 5, "y_m": 40}, {"x_m": 0, "y_m": 150}, {"x_m": 3, "y_m": 20}]
    asked = PLANAR | {"question": question, "states": starts, "proofs": True}
    outputs = execute("go-no-go", asked).document["outputs"]
    assert outputs["verdict"] == ["GO", "NO_GO", "GO"]
    assert outputs["decided_by"] == ["tracking", "exact", "tracking"]
    for verdict, proof, margin in zip(outputs["verdict"], outputs["proof"], outputs["margin_m"], strict=True):
        shown = checker.check(proof)
        assert shown.verdict == verdict
        assert shown.margin_m == pytest.approx(margin, abs=1e-6)
    near, far, _ = outputs["tracking"]
    assert near["certified"]
    assert near["arrives_s"] == 58.0
    assert near["exact_verdict"] == "GO"
    assert near["exact_margin_m"] >= near["margin_m"]
    assert not far["feasible"]
    assert far["least_violation_m"] > 0.0
    assert (outputs["end_s"] or [None])[0] == (58.0 if question == "synchronize" else None)


def test_a_hold_after_its_arrival():
    asked = PLANAR | {"omega_t_deg_s": 2, "a_max_m_s2": 0.05, "question": "synchronize", "proofs": True}
    asked |= {"after_arrival": "hold", "states": [{"x_m": 5, "y_m": 40}, {"x_m": 20, "y_m": 78}]}
    outputs = execute("go-no-go", asked).document["outputs"]
    assert outputs["verdict"] == ["GO", "NO_GO"]
    near, far = outputs["hold_after"]
    assert (near["code"], far) == ("proved", None)
    assert any("under a feedback" in line for line in checker.check(outputs["proof"][0]).statement)


def test_what_it_cannot_take_is_undecided_beside_the_exact_answer():
    """A regulator with a short horizon has no plan where the exact answer is GO."""
    tuned = {"n_c": 1, "n_lqr": 1}
    asked = PLANAR | {"tracking": tuned, "states": [{"x_m": 5, "y_m": 40}]}
    outputs = execute("go-no-go", asked).document["outputs"]
    assert outputs["verdict"] == ["UNDECIDED"]
    assert outputs["margin_m"] == [None]
    assert outputs["tracking"][0]["exact_verdict"] == "GO"
    assert "exact: a thrust history keeps" in outputs["reason"][0]


@pytest.mark.parametrize(
    "thrust",
    [
        {"kind": "ball", "a_max_m_s2": 0.1},
        {"kind": "box", "a_max_m_s2": [0.1, 0.1, 0.12], "frame": "body"},
        {"kind": "box", "a_max_m_s2": [0.1, 0.1, 0.12], "frame": "lvlh"},
    ],
)
def test_a_freely_tumbling_target(thrust):
    starts = [{"position_m": [1.5, 4, 1.5]}, {"position_m": [0, 40, 0]}]
    asked = SPACE | {"thrust": thrust, "starts": starts, "horizon_s": 24, "proofs": True, "flights": True}
    outputs = execute("start-in-space", asked).document["outputs"]
    assert outputs["verdict"] == ["GO", "UNDECIDED"]
    assert [one["certified"] for one in outputs["tracking"]] == [True, False]
    shown = checker.check(outputs["proof"][0])
    assert shown.verdict == "GO"
    least = np.min(outputs["flight"][0]["distance_m"])
    assert shown.margin_m - 1e-6 <= outputs["margin_m"][0] <= least
    assert outputs["proof"][1] is outputs["flight"][1] is None


def test_a_start_in_the_body_s_axes():
    thrust = {"kind": "ball", "a_max_m_s2": 0.1}
    starts = [{"position_m": [2, 9, 1], "frame": "body"}]
    outputs = execute("start-in-space", SPACE | {"thrust": thrust, "starts": starts}).document["outputs"]
    assert outputs["verdict"] == ["GO"]
    assert outputs["tracking"][0]["certified"]


def test_a_corridor_along_another_axis():
    """The corridor and the start turned by the same rotation give the same flight."""
    plain = SPACE | {
        "attitude": {"kind": "spin", "rate_deg_s": 3.0, "axis": [0, 1, 0]},
        "thrust": {"kind": "ball", "a_max_m_s2": 0.1},
        "starts": [{"position_m": [2, 9, 1]}],
        "orbit": {"mean_motion_rad_s": 0.0},
    }
    turned = plain | {
        "attitude": {"kind": "spin", "rate_deg_s": 3.0, "axis": [1, 0, 0]},
        "corridor": SPACE["corridor"] | {"axis": [1, 0, 0]},
        "starts": [{"position_m": [9, -2, 1]}],
    }
    one, other = (execute("start-in-space", asked).document["outputs"] for asked in (plain, turned))
    assert one["verdict"] == other["verdict"] == ["GO"]
    assert one["margin_m"] == pytest.approx(other["margin_m"], abs=1e-9)
    assert one["tracking"][0]["delta_v_m_s"] == pytest.approx(other["tracking"][0]["delta_v_m_s"], abs=1e-7)


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"speed_limit_m_s": 1.0}, "method"),
        ({"disturbance_m_s2": 0.001}, "method"),
        ({"hold_x_m": 1.0}, "hold_y_m"),
        ({"method": "exact", "tracking": {}}, "tracking"),
        ({"tracking": {"n_c": 40}}, "n_c"),
        ({"tracking": {"theta_limit": "zero"}}, "theta_limit"),
        ({"states": [{"x_m": 0, "y_m": 5}] * 51}, "states"),
    ],
)
def test_refusals(wrong, field):
    with pytest.raises(InvalidInput, match=field):
        execute("go-no-go", PLANAR | {"states": [{"x_m": 0, "y_m": 5}]} | wrong)


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"orbit": {"semi_major_axis_m": 8e6, "eccentricity": 0.1}}, "orbit"),
        ({"corridor": {"faces": [{"name": "a", "normal": [0, -1, 0], "offset_m": 0}]}}, "corridor"),
        ({"thrust": {"kind": "box", "a_max_m_s2": [0.1, 0, 0.1]}}, "thrust"),
        ({"method": "auto", "tracking": {}}, "tracking"),
        ({"question": "synchronize"}, "question"),
        ({"position_half_width_m": 0.1}, "position_half_width_m"),
    ],
)
def test_refusals_in_space(wrong, field):
    asked = SPACE | {"thrust": {"kind": "ball", "a_max_m_s2": 0.1}, "starts": [{"position_m": [0, 5, 0]}]}
    with pytest.raises(InvalidInput, match=field):
        execute("start-in-space", asked | wrong)


def test_a_go_that_arrives_after_the_horizon_is_proved_until_then():
    attitude = SPACE["attitude"] | {"body_rate_deg_s": [0, 1, 1]}
    asked = {
        "attitude": attitude,
        "orbit": SPACE["orbit"],
        "method": "tracking",
        "thrust": {"kind": "ball", "a_max_m_s2": 0.03},
        "starts": [{"position_m": [-10, 25, 0]}],
        "proofs": True,
        "flights": True,
    }
    outputs = execute("start-in-space", asked).document["outputs"]
    arrives = outputs["tracking"][0]["arrives_s"]
    assert outputs["verdict"] == ["GO"]
    assert arrives > 60.0
    proof, flight = outputs["proof"][0], outputs["flight"][0]
    assert (
        2.0 * len(proof["thrust_m_s2"]) == flight["time_s"][-1] == outputs["turning"]["time_s"][-1] == arrives
    )
    shown = checker.check(proof)
    assert shown.verdict == "GO"
    assert shown.margin_m == pytest.approx(outputs["margin_m"][0], abs=1e-6)
    assert f"for {arrives:g} s" in outputs["reason"][0]


def test_so_is_one_in_the_plane():
    asked = {"omega_t_deg_s": 1, "a_max_m_s2": 0.03, "method": "tracking", "states": [{"x_m": 0, "y_m": 40}]}
    outputs = execute("go-no-go", asked | {"proofs": True, "horizon_s": 20}).document["outputs"]
    proof, arrives = outputs["proof"][0], outputs["tracking"][0]["arrives_s"]
    assert outputs["verdict"] == ["GO"]
    assert 2.0 * len(proof["thrust_m_s2"]) == arrives > 20.0
    assert checker.check(proof).margin_m == pytest.approx(outputs["margin_m"][0], abs=1e-6)


def test_a_flight_that_is_late_has_not_lost_its_plan():
    asked = PLANAR | {"states": [{"x_m": 5, "y_m": 40}], "within_s": 30, "horizon_s": 20}
    outputs = execute("go-no-go", asked).document["outputs"]
    assert outputs["verdict"] == ["UNDECIDED"]
    assert "keeps its plan, but is not at rest at the port within 30 s" in outputs["reason"][0]

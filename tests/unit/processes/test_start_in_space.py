"""The question in space as a process: its parts, the short form, its refusals, its proofs."""

from __future__ import annotations

import copy
import json
import math
from typing import Any

import numpy as np
import pytest

from safestart.attitude.in_lvlh import InLvlh
from safestart.attitude.spin import Spin
from safestart.attitude.torque_free import TorqueFree
from safestart.errors import InvalidInput
from safestart.processes.execute import execute
from safestart.processes.registry import process
from safestart.processes.start_in_space.question import question_of, states_of
from safestart.proofs.checker import check
from safestart.runtime.progress import Context

SPEC = process("start-in-space")
SHORT = {"starts": [{"position_m": [1, 30, 0.5]}], "omega_t_deg_s": 3, "a_max_m_s2": 0.1}
BODY = [[120, 2, -1], [2, 100, 3], [-1, 3, 60]]


def asked(**changes: Any) -> Any:
    return SPEC.parse(copy.deepcopy(SHORT) | changes)


def answered(**changes: Any) -> dict[str, Any]:
    outputs: dict[str, Any] = execute(SPEC.id, copy.deepcopy(SHORT) | changes, Context()).document["outputs"]
    return outputs


def test_the_short_form_is_go_no_go_s_answer() -> None:
    states = [{"x_m": 1, "y_m": 30, "z_m": 0.5}, {"x_m": 1, "y_m": 148, "z_m": 0.5}]
    point = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1}
    old = execute("go-no-go", point | {"states": states, "method": "exact"}, Context()).document["outputs"]
    starts = [{"position_m": [s["x_m"], s["y_m"], s["z_m"]]} for s in states]
    new = execute(SPEC.id, point | {"starts": starts}, Context()).document["outputs"]
    assert new["verdict"] == old["verdict"] == ["GO", "NO_GO"]
    assert new["decided_by"] == old["decided_by"] == ["exact", "exact"]
    np.testing.assert_allclose(new["margin_m"], old["margin_m"], atol=2e-4)
    assert new["faces"] == old["faces"]


def test_proofs_verify() -> None:
    found = answered(
        starts=[
            {"position_m": [1, 30, 0.5], "velocity_m_s": [0, -0.1, 0], "frame": "body"},
            {"position_m": [1, 9, 20]},
        ],
        omega_t_deg_s=None,
        attitude={"kind": "torque_free", "inertia_kg_m2": BODY, "body_rate_deg_s": [1, -1, 2]},
        orbit={"semi_major_axis_m": 2.4e7, "eccentricity": 0.7, "true_anomaly_deg": 10},
        proofs=True,
    )
    assert found["verdict"][1] == "NO_GO"
    assert found["violated_faces"][1] == ["top"]
    for verdict, margin, document in zip(found["verdict"], found["margin_m"], found["proof"], strict=True):
        verified = check(json.loads(json.dumps(document)))
        assert verified.verdict == verdict
        assert abs(verified.margin_m - margin) < 1e-6


def test_parts_are_what_they_say() -> None:
    spin = {"kind": "spin", "axis": [1, 2, 2], "axis_frame": "inertial", "rate_deg_s": -3, "phase_deg": 90}
    question = question_of(asked(omega_t_deg_s=None, attitude=spin, mean_motion_rad_s=1e-3))
    assert isinstance(question.attitude, InLvlh)
    assert question.attitude.inertial == Spin(math.radians(-3), (1 / 3, 2 / 3, 2 / 3), math.pi / 2)
    assert question.orbit.mean_motion == 1e-3
    free = {"kind": "torque_free", "inertia_kg_m2": BODY, "body_rate_deg_s": [0, 0, 2], "reference": "lvlh"}
    seen = question_of(asked(omega_t_deg_s=None, attitude=free)).attitude
    assert isinstance(seen, InLvlh)
    assert isinstance(seen.inertial, TorqueFree)
    np.testing.assert_allclose(seen.angular_velocity(np.zeros(1))[0], [0, 0, math.radians(2)], atol=1e-15)
    axis = question_of(asked(corridor={"axis": [0, 0, -2], "r_h_m": 1.0}))
    assert axis.faces[0].name == "hold_plane"
    np.testing.assert_allclose(axis.faces[0].normal, [0, 0, 1], atol=1e-15)
    assert axis.faces[0].offset == -1.0


def test_starts_in_the_body_frame_are_turned() -> None:
    """At rest against the turning body: v = omega x r in LVLH."""
    inputs = asked(starts=[{"position_m": [1, 30, 0.5], "frame": "body"}])
    state = states_of(inputs, question_of(inputs))[0]
    rate = math.radians(3)
    np.testing.assert_allclose(state, [1, 30, 0.5, -30 * rate, rate, 0], atol=1e-14)


def test_faces_of_both_frames_and_thrusters() -> None:
    cone = {
        "faces": [
            {"name": f"f{k}", "normal": n, "offset_m": 2, "frame": f}
            for k, (n, f) in enumerate(
                (([0, -1, 0], "body"), ([1, -1, 0], "body"), ([-1, -1, 0], "lvlh"), ([0, 1, 0], "lvlh"))
            )
        ]
    }
    cone["faces"][3]["offset_m"] = 60
    arms = {
        "kind": "thrusters",
        "directions": [[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]],
        "a_max_m_s2": [0.1, 0.1, 0.1, 0.1],
        "frame": "body",
    }
    found = answered(corridor=cone, thrust=arms, a_max_m_s2=None, proofs=True)
    assert check(json.loads(json.dumps(found["proof"][0]))).verdict == found["verdict"][0]
    assert found["faces"] == ["f0", "f1", "f2", "f3"]


TABLE = {"kind": "table", "times_s": [0, 10], "attitude_wxyz": [[1, 0, 0, 0], [1, 0, 0, 0]]}
FREE = {"kind": "torque_free", "inertia_kg_m2": BODY, "body_rate_deg_s": [1, 0, 0]}


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"attitude": TABLE}, "attitude"),
        ({"omega_t_deg_s": None}, "attitude"),
        ({"a_max_m_s2": None}, "thrust"),
        ({"omega_t_deg_s": None, "attitude": TABLE}, "attitude.times_s"),
        (
            {"omega_t_deg_s": None, "attitude": TABLE | {"attitude_wxyz": [[1, 0, 0, 0], [0, 0, 0, 0]]}},
            "attitude.attitude_wxyz",
        ),
        (
            {"omega_t_deg_s": None, "attitude": FREE | {"inertia_kg_m2": [[1, 0, 0], [0, 1, 0], [0, 0, 3]]}},
            "attitude.inertia_kg_m2",
        ),
        (
            {
                "omega_t_deg_s": None,
                "attitude": FREE | {"inertia_kg_m2": [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]},
            },
            "attitude.inertia_kg_m2",
        ),
        (
            {"omega_t_deg_s": None, "attitude": FREE | {"body_rate_deg_s": [61, 0, 0]}},
            "attitude.body_rate_deg_s",
        ),
        (
            {"omega_t_deg_s": None, "attitude": {"kind": "spin", "axis": [0, 0, 0], "rate_deg_s": 1}},
            "attitude.axis",
        ),
        ({"orbit": {"semi_major_axis_m": 7.0e6, "eccentricity": 0.5}}, "orbit.eccentricity"),
        ({"orbit": {"semi_major_axis_m": 7.0e7, "eccentricity": 0.85}}, "orbit.eccentricity"),
        ({"corridor": {"faces": []}}, "corridor.faces"),
        ({"corridor": {"faces": [{"name": "a", "normal": [0, 0, 1], "offset_m": 9}] * 2}}, "corridor.faces"),
        ({"corridor": {"axis": [0, 0, 0]}}, "corridor.axis"),
        (
            {
                "corridor": {
                    "faces": [{"name": n, "normal": [0, 0, int(n == "a")], "offset_m": 9} for n in "ab"]
                }
            },
            "corridor.faces.1.normal",
        ),
        (
            {
                "a_max_m_s2": None,
                "thrust": {"kind": "thrusters", "directions": [[1, 0, 0]] * 3, "a_max_m_s2": [1, 1, 1]},
            },
            "thrust.directions",
        ),
        ({"a_max_m_s2": None, "thrust": {"kind": "box", "a_max_m_s2": [0, 0, 0]}}, "thrust.a_max_m_s2"),
        ({"starts": [{"position_m": [1, 2]}]}, "starts.0.position_m"),
        ({"keep_outs": [{"name": "a", "radius_m": 0}]}, "keep_outs.0.radius_m"),
        ({"keep_outs": [{"name": "a", "half_widths_m": [1, 2]}]}, "keep_outs.0.half_widths_m"),
        (
            {"keep_outs": [{"name": "a", "radius_m": 1, "half_widths_m": [1, 2, 3]}]},
            "keep_outs.0.half_widths_m",
        ),
        ({"keep_outs": [{"name": "a", "radius_m": 1}] * 2}, "keep_outs"),
        ({"keep_outs": [{"name": "left", "radius_m": 1}]}, "keep_outs"),
        ({"keep_outs": [{"name": "a", "radius_m": 1, "centre_m": [1e6, 0, 0]}]}, "keep_outs.0.centre_m"),
        ({"field_of_view": {"axis": [0, 0, 0], "half_angle_deg": 10}}, "field_of_view.axis"),
        ({"field_of_view": {"axis": [0, 1, 0], "half_angle_deg": 90}}, "field_of_view.half_angle_deg"),
        (
            {"field_of_view": {"axis": [0, 1, 0], "half_angle_deg": 20, "point_m": [1e6, 0, 0]}},
            "field_of_view.point_m",
        ),
        ({"plume": {"half_angle_deg": 85, "range_m": 10}}, "plume.half_angle_deg"),
        ({"plume": {"half_angle_deg": 20}}, "plume.range_m"),
        ({"plume": {"half_angle_deg": 20, "range_m": 10}, "position_half_width_m": 1}, "question"),
        ({"plume": {"half_angle_deg": 20, "range_m": 10}, "method": "tracking"}, "plume"),
        ({"starts": [{"position_m": [1, 20_000, 0]}]}, "starts.0.position_m.1"),
        ({"starts": [{"position_m": [1, 2, 0], "velocity_m_s": [0, 0, 2000]}]}, "starts.0.velocity_m_s.2"),
        ({"omega_t_deg_s": None, "attitude": {"kind": "euler"}}, "attitude.kind"),
        ({"omega_t_deg_s": None, "attitude": {"axis": [0, 0, 1]}}, "attitude.kind"),
        ({"orbit": {}}, "orbit.mean_motion_rad_s"),
        (
            {"corridor": {"faces": [{"name": "", "normal": [0, 0, 1], "offset_m": 9}]}},
            "corridor.faces.0.name",
        ),
    ],
)
def test_refusals_name_the_field(changes: dict[str, Any], field: str) -> None:
    with pytest.raises(InvalidInput) as refused:
        answered(**changes)
    assert refused.value.field == field


def test_the_model_s_error_is_beside_the_margin() -> None:
    """About what two bodies with J2 change: 58 mm after 300 s at 200 m above 400 km (benchmarks/model_error.py)."""
    far = {"position_m": [141.4, 141.4, 0.0]}
    orbit = {"semi_major_axis_m": 6.778e6, "eccentricity": 0.0}
    plane = {"faces": [{"name": "plane", "normal": [0, -1, 0], "offset_m": -141.36, "frame": "lvlh"}]}
    found = answered(starts=[far], orbit=orbit, horizon_s=300, corridor=plane)
    assert 0.058 < found["model_error_m"][0] < 0.116
    assert "the linear model itself may be off by about 0.067 m" in found["reason"][0]
    assert answered(starts=[far], mean_motion_rad_s=0)["model_error_m"] == [0.0]


def test_demands_are_named_with_the_part_that_answered_them() -> None:
    """Never dropped: in the verdict's words, among what the start violates, and in the proof."""
    demands = {
        "keep_outs": [{"name": "panel", "radius_m": 5, "centre_m": [0, 10, 0]}],
        "field_of_view": {"axis": [0, -1, 0], "half_angle_deg": 60},
        "plume": {"half_angle_deg": 30, "range_m": 60},
    }
    starts = [{"position_m": [1, 25, 0.5]}, {"position_m": [1, 8, 0.5]}, {"position_m": [1, 148, 0.5]}]
    found = answered(starts=starts, **demands, horizon_s=40, proofs=True)
    assert found["verdict"] == ["GO", "NO_GO", "NO_GO"]
    assert found["violated_faces"] == [[], ["panel"], []]
    assert [len(row) for row in found["restriction"]] == [3, 0, 0]
    assert "convex part" in found["reason"][0]
    assert "wrong side of panel" in found["reason"][1]
    assert "even without panel, field_of_view, plume" in found["reason"][2]
    assert found["proof"][1]["violated"] == "panel"
    for proof in found["proof"]:
        assert set(demands) <= set(proof["question"])
        check(json.loads(json.dumps(proof)))
    assert answered(horizon_s=40)["restriction"] is None


def test_a_no_go_by_the_view_says_by_how_much_it_misses_a_limit_or_the_view() -> None:
    view = {"axis": [0, -1, 0], "half_angle_deg": 30, "frame": "body"}
    start = {"position_m": [5, 40, 0]}
    (reason,) = answered(starts=[start], omega_t_deg_s=3, a_max_m_s2=0.1, field_of_view=view)["reason"]
    assert "each history misses a limit or field_of_view by at least 4.64 m" in reason


def test_what_else_is_not_known_counts_and_is_proved() -> None:
    free = {"kind": "torque_free", "inertia_kg_m2": BODY, "body_rate_deg_s": [0.2, -0.3, 1]}
    known = {
        "starts": [{"position_m": [1, 30, 0.5]}, {"position_m": [1, 9, 20]}],
        "omega_t_deg_s": None,
        "attitude": free,
        "proofs": True,
    }
    sure = answered(**known)
    half = {
        "attitude_half_angle_deg": 1,
        "body_rate_half_width_deg_s": 0.01,
        "inertia_half_width": 0.01,
        "disturbance_m_s2": 1e-4,
        "position_half_width_m": 0.2,
    }
    found = answered(**known, **half)
    assert found["verdict"] == sure["verdict"] == ["GO", "NO_GO"]
    assert found["decided_by"] == ["families", "families"]
    assert sure["decided_by"] == ["exact", "exact"]
    assert 0.0 < found["margin_m"][0] < sure["margin_m"][0] - 0.5
    assert "for every member of what is not known" in found["reason"][0]
    assert "even where all is as given" in found["reason"][1]
    for document in found["proof"]:
        assert document["question"]["unknowns"]["inertia_share"] == 0.01
        check(json.loads(json.dumps(document)))
    wide = answered(**known | {"proofs": False, "starts": known["starts"][:1]}, body_rate_half_width_deg_s=5)
    assert wide["verdict"] == ["UNDECIDED"]
    assert "may turn the body any way" in wide["reason"][0]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"inertia_half_width": 0.1}, "inertia_half_width: required 0 unless the attitude is torque_free"),
        ({"disturbance_m_s2": 1e-3, "question": "synchronize"}, "question: required stay"),
        ({"attitude_half_angle_deg": 1, "speed_limit_m_s": 1}, "question: required stay"),
        (
            {"attitude_half_angle_deg": 1, "plume": {"half_angle_deg": 20, "range_m": 40}},
            "question: required stay",
        ),
        (
            {
                "attitude_half_angle_deg": 1,
                "a_max_m_s2": None,
                "thrust": {"kind": "box", "a_max_m_s2": [1, 1, 1], "frame": "body"},
            },
            "thrust.frame: required axes of LVLH",
        ),
        ({"method": "tracking", "disturbance_m_s2": 1e-3, "mean_motion_rad_s": 1e-3}, "disturbance_m_s2"),
    ],
)
def test_what_is_not_asked_together_is_refused(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        answered(**changes)
    assert said in str(caught.value)

"""passive-abort with its plan in a file, and hop-angles: the questions on the wire."""

import pytest

from safestart.errors import InvalidInput
from safestart.processes.execute import execute
from tests.unit.missed_burn.test_plan_file import _flown

CSV = "time_s,dv_x_m_s,dv_y_m_s,dv_z_m_s\n0,0.0178,0,0\n3627.5,0.0178,0,0\n"
START = {"position_m": [0.0, 182.06, 0.0], "velocity_m_s": [0.0, 0.0, 0.0]}
ASKED = {"keep_out_m": 40, "abort_orbits": 1, "error_level": False}


def _outputs(process: str, inputs: dict) -> dict:
    return execute(process, inputs).document["outputs"]


def test_burns_in_csv_are_the_burns_themselves() -> None:
    burns = [{"time_s": 0, "impulse_m_s": [0.0178, 0, 0]}, {"time_s": 3627.5, "impulse_m_s": [0.0178, 0, 0]}]
    named = _outputs("passive-abort", ASKED | {"start": START, "burns": burns})
    filed = _outputs("passive-abort", ASKED | {"start": START, "plan": CSV})
    assert filed.pop("read")["burns"] == [{**burn, "duration_s": 0.0} for burn in burns]
    assert named.pop("read") is None
    assert filed == named


@pytest.mark.parametrize("model", ["linear", "nonlinear", "earth"])
def test_a_message_asks_the_question_that_it_is_read_as(model: str) -> None:
    opm, _, target = (data.decode() for data in _flown("RTN"))
    filed = _outputs("passive-abort", ASKED | {"plan": opm, "target": target, "model": model})
    read = filed["read"]
    orbit = {
        name: read[name]
        for name in (
            "semi_major_axis_m",
            "eccentricity",
            "inclination_deg",
            "argument_of_perigee_deg",
            "true_anomaly_deg",
        )
        if model == "earth" or name == "semi_major_axis_m"
    }
    again = _outputs(
        "passive-abort", ASKED | orbit | {"start": read["start"], "burns": read["burns"], "model": model}
    )
    assert (again["verdict"], again["least_distance_m"]) == (filed["verdict"], filed["least_distance_m"])
    assert ("eccentricity" in " ".join(filed["notes"])) == (model != "earth")


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({}, "burns"),
        ({"start": START}, "burns"),
        ({"plan": CSV}, "start"),
        ({"start": START, "plan": CSV, "burns": [{"time_s": 0, "impulse_m_s": [1, 0, 0]}]}, "burns"),
        ({"start": START, "plan": CSV, "target": "x"}, "target"),
        ({"plan": CSV, "target": "x"}, "target"),
        ({"plan": "CCSDS_OPM_VERS = 2.0", "start": START}, "target"),
        ({"plan": "CCSDS_OPM_VERS = 2.0", "target": "x", "eccentricity": 0.1}, "eccentricity"),
        ({"start": START, "plan": "time_s,dv_x_m_s,dv_y_m_s,dv_z_m_s\n10,1,0,0\n5,1,0,0\n"}, "burns"),
        ({"start": START, "plan": "time_s,dv_x_m_s,dv_y_m_s,dv_z_m_s\n10,0,0,0\n"}, "burns"),
        ({"start": START, "plan": "hello"}, "plan"),
    ],
)
def test_plans_that_are_refused(wrong: dict, field: str) -> None:
    with pytest.raises(InvalidInput, match=field):
        execute("passive-abort", wrong)


def test_lines_for_a_time_and_for_a_fuel() -> None:
    found = _outputs("hop-angles", {"orbits": 0.6})
    assert [round(one["angle_deg"], 1) for one in found["angles"]] == [52.0, 116.8]
    for one in found["angles"]:
        plan = _outputs("hop-plan", {"angle_deg": one["angle_deg"]})["plan"]
        assert plan["orbits"] == pytest.approx(0.6, abs=1e-8) == one["orbits"]
        assert plan["fuel_1norm_m_s"] == pytest.approx(one["fuel_1norm_m_s"], rel=1e-12)
    none = _outputs("hop-angles", {"fuel_2norm_m_s": 20.0})
    assert none["angles"] == []
    assert none["greatest"] < 20.0
    assert none["wanted"] == "fuel_2norm_m_s"
    assert none["greatest_angle_deg"] == pytest.approx(145.7, abs=0.2)


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({}, "orbits"),
        ({"orbits": 0.6, "fuel_1norm_m_s": 8.0}, "orbits"),
        ({"orbits": 0.0}, "orbits"),
        ({"orbits": 0.6, "hold_m": 3000.0}, "start_m"),
        ({"orbits": 0.6, "gamma": 1e-9}, "gamma"),
        ({"orbits": 0.6, "semi_major_axis_m": 6.3e6}, "semi_major_axis_m"),
    ],
)
def test_questions_without_a_line(wrong: dict, field: str) -> None:
    with pytest.raises(InvalidInput, match=field):
        execute("hop-angles", wrong)

"""One folder or file and one line, as docs/extending.md says, for the parts that a person adds."""

from __future__ import annotations

import csv
import io
import json
from typing import Any

import pytest

from tests.contract.extending.house import House

PROCESSES = "core/safestart/processes"
METHODS = f"{PROCESSES}/go_no_go"
DYNAMICS = "core/safestart/dynamics"
CONTROL = "core/safestart/control"
FORMS = "service/safestart_service/documents/formats"
PROCESS = '    "drift": "safestart.processes.drift.spec",'
METHOD = '    Method("reserve", "a metre in reserve", f"{_HERE}.reserve:decide", proves=False, at_once=True),'
CONTROLLER = (
    '    Offered("damper", "damper", "brakes", "safestart.control.damper:for_sweep", note="It only brakes."),'
)
FORM = '    "json_lines",'
MOTION = '    NamedMotion("straight", "no gravity", "safestart.dynamics.straight:straight_of"),'

Touched = tuple[list[str], list[str]]


@pytest.fixture(scope="module")
def extended(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[Touched], dict[str, Any]]:
    """The touched files after each added part, and the answers of the copy with all parts."""
    house = House(tmp_path_factory.mktemp("house"))
    touched = [house.touched()]
    house.add("drift", f"{PROCESSES}/drift")
    house.add_line(f"{PROCESSES}/registry.py", '"trade-study"', PROCESS)
    touched.append(house.touched())
    house.add("reserve.py", f"{METHODS}/methods/reserve.py")
    house.add_line(f"{METHODS}/method_registry.py", "_ALL = (", METHOD)
    touched.append(house.touched())
    house.add("damper.py", f"{CONTROL}/damper.py")
    house.add_line(f"{PROCESSES}/sweep/controllers.py", "_ALL = (", CONTROLLER)
    touched.append(house.touched())
    house.add("json_lines.py", f"{FORMS}/json_lines.py")
    house.add_line(f"{FORMS}/registry.py", '"parquet"', FORM)
    touched.append(house.touched())
    house.add("straight.py", f"{DYNAMICS}/straight.py")
    house.add_line(f"{DYNAMICS}/registry.py", "_ALL = (", MOTION)
    touched.append(house.touched())
    return touched, house.ask()


def test_each_is_a_folder_or_a_file_and_a_line(extended: tuple[list[Touched], dict[str, Any]]) -> None:
    new = [
        f"{PROCESSES}/drift",
        f"{METHODS}/methods/reserve.py",
        f"{CONTROL}/damper.py",
        f"{FORMS}/json_lines.py",
        f"{DYNAMICS}/straight.py",
    ]
    lines = [f"+{PROCESS}", f"+{METHOD}", f"+{CONTROLLER}", f"+{FORM}", f"+{MOTION}"]
    found = [(sorted(files), sorted(changed)) for files, changed in extended[0]]
    assert found == [(sorted(new[:parts]), sorted(lines[:parts])) for parts in range(6)]


def test_a_process(extended: tuple[list[Touched], dict[str, Any]]) -> None:
    found = extended[1]["process"]
    printed = found["printed"]
    assert printed["closest_m"] == pytest.approx(0.0, abs=1e-9), "100 m at 0.2 m/s, without an orbit"
    assert printed["closest_s"] == 500.0
    assert found["at_once"] == printed
    rows = list(csv.DictReader(io.StringIO(found["table"])))
    assert [float(row["time_s"]) for row in rows] == printed["time_s"]
    assert float(rows[50]["position_m.1"]) == printed["position_m"][50][1]
    assert found["refused"] == [422, "inputs.position_m"]
    at = found["listed"].index("trade-study")
    assert found["listed"][at + 1] == "drift", "in the order of the registry"
    assert sorted(found["schemas"]) == ["DriftInputs", "DriftOutputs", "ExecuteDrift"]
    described = found["description"]
    assert described["inputs"]["position_m"]["minOccurs"] == 1
    assert described["outputs"]["closest_m"]["description"] == "Smallest distance to the target's centre."


def test_its_view_is_a_part_of_it(extended: tuple[list[Touched], dict[str, Any]]) -> None:
    described = extended[1]["process"]["description"]
    (view,) = described["safestart:views"]
    assert view["kind"] == "facts"
    assert [column["path"] for column in view["columns"]] == ["closest_m", "closest_s"]
    assert described["safestart:view_kinds"] == ["facts"]


def test_a_method_of_go_no_go(extended: tuple[list[Touched], dict[str, Any]]) -> None:
    found = extended[1]["method"]
    one, closed = found["one"], found["paper"]
    assert one["method"] == "reserve"
    assert one["margin_m"] == closed["margin_m"] - 1.0
    assert one["face_margins_m"] == closed["face_margins_m"]
    assert one["reason"] == f"{one['margin_m']:.2f} m beyond a reserve of 1 m at right"
    assert found["many"]["verdict"] == ["GO", "GO"]
    assert found["many"]["margin_m"] == [one["margin_m"]] * 2
    assert found["printed"] == one
    assert found["proof"] == "safestart-proof/1", "of the exact answer: the method has none"
    assert "'reserve'" in found["refused"]
    assert found["parameter"]["schema"]["enum"] == [
        *("reserve", "certified", "paper", "exact", "auto", "tracking", "closed_form")
    ]
    assert "reserve: a metre in reserve." in found["parameter"]["description"]


def test_a_controller(extended: tuple[list[Touched], dict[str, Any]]) -> None:
    found = extended[1]["controller"]
    assert "damper" in found["offered"]["items"]["enum"]
    assert "damper: brakes" in found["offered"]["description"]
    outputs = found["outputs"]
    assert (
        outputs["evaluated"]["damper"]
        == outputs["cells"][0]["feasible"]["damper"]
        + outputs["confusion"]["paper"]["damper"]["fp"]
        + outputs["confusion"]["paper"]["damper"]["tn"]
    )
    assert outputs["control_steps"] == {"damper": 4 * 5}
    assert outputs["delta_v_m_s"]["damper"]["mean"] > 0.0
    assert "damper: It only brakes." in outputs["notes"]
    assert "stayed: damper" in found["columns"]


def test_a_form_of_results(extended: tuple[list[Touched], dict[str, Any]]) -> None:
    found = extended[1]["form"]
    assert [json.loads(line)["verdict"] for line in found["named"].splitlines()] == ["GO", "NO_GO"]
    assert found["file"].endswith('.jsonl"')
    assert found["negotiated"] == ["application/jsonl", True]
    assert "application/jsonl" in found["offered"]
    assert "jsonl" in found["parameter"]["description"]


def test_a_motion(extended: tuple[list[Touched], dict[str, Any]]) -> None:
    found = extended[1]["motion"]
    assert found["offered"] == ["straight", "cwh", "two_body_j2"]
    assert "straight: no gravity" in found["description"]
    assert [note for note in found["notes"] if "CWH;" in note or "two_body" in note] == [], (
        "not of this motion"
    )
    assert "straight: the certificates speak of CWH." in found["notes"]
    assert found["coasted"] == [[5.0, 40.0, 0.0]] * 6, "at rest without gravity"

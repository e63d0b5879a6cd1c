"""JSON is validated by one rule, wherever it comes from: what a POST refuses, no other channel answers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import safestart as ss
from safestart.cli import build
from safestart.errors import InvalidInput
from safestart.model.strict_json import NotJson, json_of, validated
from safestart.processes.execute import execute
from safestart.processes.registry import PROCESS_IDS, process
from safestart.public.wire import sent
from safestart_worker.cluster import task

if TYPE_CHECKING:
    from starlette.testclient import TestClient

POINT = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1}
FLAT = POINT | {"x_m": 2, "y_m": 40}
WRONG: list[Any] = [True, "1", " 40 ", "4_0", None, [1]]


def told(arguments: list[str], input_text: str | None = None) -> Result:
    return CliRunner().invoke(build(), arguments, input=input_text)


def refused(arguments: list[str], input_text: str | None = None) -> str:
    """The sentence of a command that refuses."""
    found = told(arguments, input_text)
    assert isinstance(found.exception, InvalidInput), found.output
    return found.exception.detail


@pytest.mark.parametrize("wrong", WRONG, ids=repr)
def test_every_way_in_refuses_what_a_post_refuses(client: TestClient, tmp_path: Path, wrong: Any) -> None:
    asked = POINT | {"states": [{"x_m": wrong, "y_m": 40}]}
    said = client.post("/go-no-go", json=asked).json()
    assert said["field"] == "states.0.x_m"
    file = tmp_path / "in.json"
    file.write_text(json.dumps(asked))
    text = json.dumps(asked)
    for command in (
        ["run", "go-no-go", "--input", str(file)],
        ["go-no-go", "--input", str(file)],
        ["go-no-go", "--input", "-"],
    ):
        assert refused(command, text) == said["detail"]
    for ask in (lambda: execute("go-no-go", asked), lambda: ss.run("go-no-go", asked, progress=False)):
        with pytest.raises(InvalidInput) as error:
            ask()
        assert error.value.detail == said["detail"]


@pytest.mark.parametrize("name", ["x_m", "omega_t_deg_s", "r_h_m", "within_s"])
@pytest.mark.parametrize("wrong", WRONG, ids=repr)
def test_a_flat_file(name: str, wrong: Any) -> None:
    detail = refused(["go-no-go", "--input", "-"], json.dumps(FLAT | {name: wrong}))
    assert detail == f"{name}: required a number, received {wrong!r}"


def test_a_flat_file_holds_objects_and_truth_values() -> None:
    space = POINT | {"position_m": [2, 25, 1.0]}
    assert "attitude" in refused(
        ["go-no-go", "--input", "-"], json.dumps(space | {"attitude": '{"kind": "spin"}'})
    )
    assert "proofs" in refused(["go-no-go", "--input", "-"], json.dumps(FLAT | {"proofs": "true"}))
    assert told(["go-no-go", "--input", "-"], json.dumps(FLAT | {"proofs": True})).exit_code == 0


@pytest.mark.parametrize("wrong", ['[2,25,"1"]', "[2,25,true]", '[2,"2_5",1]', "[2,25,[1]]"])
def test_a_list_in_a_query_and_in_an_option(client: TestClient, wrong: str) -> None:
    start = POINT | {"position_m": json.loads(wrong)}
    posted = client.post("/go-no-go", json=POINT | {"starts": [{"position_m": start["position_m"]}]})
    for name in ("position_m", "velocity_m_s"):
        query = {"position_m": "[2,25,1]"} | {name: wrong}
        got = client.get("/go-no-go", params=POINT | query)
        assert (got.status_code, posted.status_code) == (422, 422)
        assert got.json()["required"] == posted.json()["required"] == "a number"
        assert got.json()["field"].startswith(f"{name}.")
        options = [part for key, text in query.items() for part in (f"--{key.replace('_', '-')}", text)]
        line = ["go-no-go", "--omega-t-deg-s", "3", "--a-max-m-s2", "0.1", *options]
        assert refused(line) == got.json()["detail"]
    right = {"position_m": "[2,25,1]", "horizon_s": "20", "flights": "true"}
    assert client.get("/go-no-go", params=POINT | right).status_code == 200


def test_scalars_beside_a_list_are_texts(client: TestClient) -> None:
    """Read by the rule of numbers in a query."""
    for name, text in (("omega_t_deg_s", "true"), ("horizon_s", "2_0"), ("flights", "perhaps")):
        asked = {"omega_t_deg_s": "3", "a_max_m_s2": "0.1", "position_m": "[2,25,1]"} | {name: text}
        assert client.get("/go-no-go", params=asked).json()["field"] == name


def test_the_corridors_of_a_timeline(tmp_path: Path) -> None:
    example = process("commit-timeline").example
    line = ["timeline", "--a-max", "0.1", "--spin", "0.5"]
    for name in ("chaser", "target"):
        (tmp_path / name).write_text(example[name])
        line += [f"--{name}", str(tmp_path / name)]
    for axis in ('[0, "-1", true]', '[0, -1, "0"]', "[0, -1, false]"):
        said = refused([*line, "--corridor", f'{{"axis": {axis}}}'])
        assert said.startswith("corridors.0.axis."), said
        assert "required a number" in said


def test_a_whole_float_is_an_integer_everywhere() -> None:
    asked = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "grid": {"nx": 31.0, "ny": 3}}
    parsed = process("certificate").parse(asked)
    assert parsed.model_dump()["grid"]["nx"] == 31
    with pytest.raises(InvalidInput, match=r"grid\.nx: required an integer, received 31\.5"):
        process("certificate").parse(asked | {"grid": {"nx": 31.5, "ny": 3}})


def test_numbers_of_numpy_are_numbers() -> None:
    plain = POINT | {"states": [{"x_m": 2.0, "y_m": 40.0}]}
    for real in (np.float64, np.float32, np.int64):
        given = POINT | {"states": [{"x_m": real(2), "y_m": real(40)}]}
        assert process("go-no-go").parse(given) == process("go-no-go").parse(plain)
    space = process("start-in-space")
    given = POINT | {"starts": [{"position_m": np.array([2.0, 25.0, 1.0])}]}
    assert space.parse(given) == space.parse(POINT | {"starts": [{"position_m": (2.0, 25.0, 1.0)}]})
    for wrong in (np.bool_(True), np.array([True]), np.str_("2"), object(), "\ud800"):
        with pytest.raises(InvalidInput):
            process("go-no-go").parse(POINT | {"states": [{"x_m": wrong, "y_m": 40}]})


@pytest.mark.parametrize(
    "points",
    [
        [True, 40.0],
        ["2", "40"],
        [[2, 40], [True, 40]],
        np.array([True, False]),
        np.array(["2", "40"]),
        np.array([True, 40.0], dtype=object),
        [[1, 2], [3]],
        None,
    ],
    ids=repr,
)
def test_python_takes_numbers_for_points(points: Any) -> None:
    scenario = ss.Scenario.of(3.0, 0.1)
    for ask in (ss.certify, ss.decide, ss.fly):
        with pytest.raises(InvalidInput, match="required"):
            ask(scenario, points)


def test_python_takes_what_numpy_and_lists_hold() -> None:
    scenario = ss.Scenario.of(3.0, 0.1)
    expected = ss.certify(scenario, [[2.0, 40.0]]).margin_m.tobytes()
    for points in ([[2, 40]], [np.array([2.0, 40.0])], np.array([[2, 40]]), [[np.float64(2), np.int64(40)]]):
        assert ss.certify(scenario, points).margin_m.tobytes() == expected
    for wrong in ((True, 0.1), (3.0, True), ("3", 0.1)):
        with pytest.raises(InvalidInput):
            ss.Scenario.of(*wrong)


@pytest.mark.parametrize("process_id", PROCESS_IDS)
def test_what_is_stored_reads_back_by_both_rules(process_id: str) -> None:
    """A worker takes stored inputs as they are; a client may send back what it was shown."""
    spec = process(process_id)
    parsed = spec.parse(spec.example)
    dumped = parsed.model_dump(mode="json")
    assert spec.stored(dumped) == spec.parse(dumped) == spec.parse(parsed) == parsed


def test_a_job_that_an_earlier_version_accepted_still_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = {"omega_t_deg_s": "3", "a_max_m_s2": 0.1, "states": [{"x_m": "2", "y_m": 40}]}
    monkeypatch.setattr(task, "_whole", lambda run, *_: run(None))
    assert task.run_job("go-no-go", asked, "key", "topic").document["outputs"]["verdict"]


def test_what_is_no_json() -> None:
    with pytest.raises(NotJson):
        validated(process("certificate").inputs, b"{")
    deep: list[Any] = []
    for _ in range(400):
        deep = [deep]
    with pytest.raises(InvalidInput, match=r"nested|depth"):
        process("certificate").parse({"grid": deep})
    with pytest.raises(InvalidInput, match="values of JSON"):
        json_of({"x": object()})


def test_a_client_sends_what_numpy_holds_as_json() -> None:
    given = POINT | {
        "starts": [{"position_m": np.array([2.0, 25.0, 1.0]), "velocity_m_s": (0, np.int64(1), 0)}]
    }
    assert sent(given)["starts"] == [{"position_m": [2.0, 25.0, 1.0], "velocity_m_s": [0, 1, 0]}]
    assert sent(None) == {}
    assert sent({"x_m": True, "y_m": "40"}) == {"x_m": True, "y_m": "40"}, "the service refuses them"
    for wrong in ({"x_m": float("nan")}, {"x_m": object()}, [1]):
        with pytest.raises(InvalidInput):
            sent(wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("document", ["[]", "null", '"text"', "3"])
def test_inputs_that_are_no_object(document: str) -> None:
    assert "required an object" in refused(["run", "certificate", "--input", "-"], document)


def test_names_that_are_one_in_json() -> None:
    with pytest.raises(InvalidInput, match="every name once"):
        sent({1: 2, "1": 3})

"""The inputs that make a run this run, as short texts."""

from __future__ import annotations

from safestart.processes.registry import PROCESS_IDS, process
from safestart_service.documents.key_inputs import key_inputs


def test_what_is_as_by_default_is_left_out() -> None:
    inputs = process("go-no-go").parse(process("go-no-go").example).model_dump(mode="json")
    assert key_inputs("go-no-go", inputs) == {
        "omega_t_deg_s": "3",
        "a_max_m_s2": "0.1",
        "states.x_m": "5",
        "states.y_m": "40",
    }
    assert key_inputs("go-no-go", inputs | {"horizon_s": 90.0})["horizon_s"] == "90"


def test_lists_are_short() -> None:
    states = [{"x_m": 1.5, "y_m": 2.0, "z_m": None}] * 2
    assert key_inputs("go-no-go", {"states": states})["states"] == "(x_m 1.5, y_m 2), (x_m 1.5, y_m 2)"
    assert key_inputs("go-no-go", {"states": states * 50_000})["states"] == "100000 entries"
    assert len(key_inputs("go-no-go", {"states": states * 4})["states"]) == 60
    assert key_inputs("of another version", {"a": {"b": [[1, 2.5], True]}, "c": None}) == {
        "a.b": "(1, 2.5), yes"
    }


def test_every_process_has_some() -> None:
    for name in PROCESS_IDS:
        inputs = process(name).parse(process(name).example).model_dump(mode="json")
        assert 1 <= len(key_inputs(name, inputs)) <= 24, name

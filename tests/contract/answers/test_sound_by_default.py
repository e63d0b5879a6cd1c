"""No process offers the paper's conditions unasked, and none without saying that they are not sound."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from safestart.processes.go_no_go.method_registry import DEFAULT, METHODS, UNPROVED
from safestart.processes.registry import PROCESS_IDS, process
from tests.contract.api.service_client import service

if TYPE_CHECKING:
    from starlette.testclient import TestClient

ROOT = Path(__file__).resolve().parents[3]
SOUND = {"certified", "exact", "auto"}
# At 2 deg/s and 0.05 m/s^2 the paper's conditions certify this start and nothing can fly it.
FALSE_GO = {"omega_t_deg_s": 2, "a_max_m_s2": 0.05}
START = {"x_m": 9.364, "y_m": 81.044}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    with service(tmp_path_factory.mktemp("service")) as made:
        yield made


def choices(schema: Any, name: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    """Every property that takes one of several certificates or methods, with its schema."""
    if isinstance(schema, dict):
        for key, inside in schema.get("properties", {}).items():
            words = set(inside.get("enum", [])) | set(inside.get("items", {}).get("enum", []))
            if "paper" in words and words & SOUND:
                yield key, inside
        for key, inside in schema.items():
            yield from choices(inside, key)
    elif isinstance(schema, list):
        for inside in schema:
            yield from choices(inside, name)


OFFERED = [
    (name, key, schema)
    for name in PROCESS_IDS
    for key, schema in choices(process(name).inputs.model_json_schema())
]


def test_those_that_say_go_are_among_them() -> None:
    assert {"go-no-go", "certificate", "thrust-map", "trade-study", "coverage", "sweep"} <= {
        name for name, _, _ in OFFERED
    }


@pytest.mark.parametrize(("name", "key", "schema"), OFFERED, ids=lambda value: str(value)[:30])
def test_the_default_is_sound_and_the_paper_is_named_not_sound(name: str, key: str, schema: Any) -> None:
    default = schema["default"]
    assert (default[0] if isinstance(default, list) else default) in SOUND
    assert "not sound" in schema["description"].lower()


def test_the_default_method_is_sound() -> None:
    assert METHODS[DEFAULT].sound
    assert set(UNPROVED) == {"paper", "closed_form"}


@pytest.mark.parametrize(
    "more",
    [
        {"x_m": 3, "y_m": 40},
        START,
        {"x_m": 3, "y_m": 40, "z_m": 5},
        {"x_m": 3, "y_m": 40, "rest": "body"},
        {"x_m": 3, "y_m": 60, "rest": "body"},
        {"x_m": 30, "y_m": 40},
        {"x_m": 3, "y_m": 40, "c_x": 0.4},
        {"x_m": 3, "y_m": 40, "question": "synchronize"},
        {"x_m": 3, "y_m": 40, "speed_limit_m_s": 3},
        {"x_m": 3, "y_m": 40, "disturbance_m_s2": 1e-4},
        {"x_m": 3, "y_m": 40, "position_half_width_m": 0.1},
    ],
    ids=str,
)
def test_a_go_has_a_proof_or_names_its_theorem(client: TestClient, more: dict[str, Any]) -> None:
    answer = client.get("/go-no-go", params={**FALSE_GO, **more}).json()
    assert answer.get("method") == "auto", answer
    assert answer["verdict"] in ("GO", "NO_GO", "UNDECIDED")
    if answer["verdict"] == "GO":
        assert answer["decided_by"] == "certified" or answer["proof_url"]
    if more == START:
        assert answer["verdict"] == "NO_GO"
        assert answer["margin_m"] < 0.0
        assert not math.isnan(answer["margin_m"])
        assert (
            client.get("/go-no-go", params={**FALSE_GO, **more, "method": "paper"}).json()["verdict"] == "GO"
        )


@pytest.mark.parametrize(
    "page", ["README.md", "docs/index.md", "docs/tutorial.md", "docs/api.md", "docs/theory/closed-form.md"]
)
def test_documents_that_name_the_method_say_so(page: str) -> None:
    text = (ROOT / page).read_text()
    assert "paper" in text
    assert "not sound" in text.lower()

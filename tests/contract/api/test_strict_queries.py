"""Every call reads its query strictly: known names only, plain numbers, and ``f=json`` of OGC clients."""

from __future__ import annotations

import re
from typing import Any
from urllib.parse import quote

import pytest

from tests.contract.api.service_client import HEAVY, POINT, assert_problem

JOB = "00000000-0000-4000-8000-000000000000"
PATHS = {"processID": "benchmark", "jobID": JOB, "name": "map.png", "keyID": "abc"}
# Pages keep their inputs in their addresses.
PAGES = ("/dashboard",)
LAX = ["1_0", "+5", "  5", "5 ", "\t5"]


def _calls(client: Any) -> list[tuple[str, str, list[dict[str, Any]]]]:
    document = client.get("/openapi.json").json()
    return [
        (
            method.upper(),
            re.sub(r"\{(\w+)\}", lambda found: PATHS[found[1]], path),
            call.get("parameters", []),
        )
        for path, calls in document["paths"].items()
        if not path.startswith(PAGES)
        for method, call in calls.items()
    ]


def _asked(client: Any, method: str, path: str) -> Any:
    body = POINT | {"states": [{"x_m": 5, "y_m": 40}]} if path.startswith("/go-no-go") else POINT
    return client.request(method, path, json=HEAVY if "/processes/" in path else body)


def test_an_unknown_parameter_is_refused_by_every_call(guarded) -> None:
    client, keys, _ = guarded
    client.headers["X-API-Key"] = keys["admin"]
    for method, path, _ in _calls(client):
        answer = _asked(client, method, f"{path}?methud=paper")
        assert "methud" in assert_problem(answer, 422)["detail"], (method, path)


def test_nothing_is_queued_with_an_unknown_parameter(queue) -> None:
    client, jobs = queue
    assert_problem(client.post("/processes/benchmark/execution?x=1", json=HEAVY), 422, "x")
    assert jobs.counts()["accepted"] == 0


@pytest.mark.parametrize("lax", LAX)
def test_a_number_is_written_as_one_in_every_query(guarded, lax: str) -> None:
    client, keys, _ = guarded
    client.headers["X-API-Key"] = keys["admin"]
    seen = 0
    for method, path, parameters in _calls(client):
        for one in parameters:
            kinds = str(one.get("schema"))
            if one["in"] != "query" or not re.search(r"'type': '(number|integer)'", kinds):
                continue
            seen += 1
            answer = _asked(client, method, f"{path}?{one['name']}={quote(lax)}")
            problem = assert_problem(answer, 422, one["name"])
            assert "without" in problem["required"], (path, one["name"])
    assert seen > 10


@pytest.mark.parametrize(
    "path", ["/", "/conformance", "/processes", "/processes/benchmark", "/jobs", "/healthz"]
)
def test_clients_of_ogc_apis_may_ask_for_json(client, path: str) -> None:
    assert client.get(f"{path}?f=json").status_code == 200
    assert_problem(client.get(f"{path}?f=html"), 422, "f")


def test_every_call_may_be_asked_for_json(guarded) -> None:
    client, keys, _ = guarded
    client.headers["X-API-Key"] = keys["admin"]
    for method, path, _ in _calls(client):
        assert_problem(_asked(client, method, f"{path}?f=html"), 422, "f")
        plain, asked = (_asked(client, method, f"{path}{more}") for more in ("", "?f=json"))
        assert (asked.status_code, asked.headers["content-type"]) == (
            plain.status_code,
            plain.headers["content-type"],
        ), (method, path)
    question = "/go-no-go?omega_t_deg_s=3&a_max_m_s2=0.1&x_m=-5&y_m=40&f=json"
    assert client.get(question).json()["verdict"] == "GO"
    assert_problem(client.get(question.replace("?", "?f=json&")), 422, "f")
    assert client.get(question.replace("go?", "go/proof?")).status_code == 200


def test_a_plain_number_is_taken(client) -> None:
    assert client.get("/jobs?limit=5&offset=0").status_code == 200
    assert client.get("/go-no-go?omega_t_deg_s=3e0&a_max_m_s2=0.1&x_m=-5&y_m=%34%30").status_code == 200

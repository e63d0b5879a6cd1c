"""What has one value comes once: names in JSON bodies, parameters in queries, lines in heads."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.contract.api.service_client import HEAVY, POINT, assert_problem

STATE = '{"x_m": 5, "y_m": 40}'
START = json.dumps(POINT)[1:-1]
TWICE = {
    "at the top": ("/certificates", f'{{{START}, "omega_t_deg_s": 4}}', "omega_t_deg_s"),
    "with the same value": ("/certificates", f"{{{START}, {START}}}", "omega_t_deg_s"),
    "by another spelling": ("/certificates", f'{{{START}, "\\u006fmega_t_deg_s": 4}}', "omega_t_deg_s"),
    "a NO_GO that became a GO": (
        "/go-no-go",
        f'{{{START}, "states": [{{"x_m": 500, "y_m": 40, "x_m": 5}}]}}',
        "x_m",
    ),
    "all states": ("/go-no-go", f'{{{START}, "states": [], "states": [{STATE}]}}', "states"),
    "in an execution": (
        "/processes/benchmark/execution",
        f'{{"inputs": {{{START}, "a_max_m_s2": 0.2, "engines": ["analytical"]}}}}',
        "a_max_m_s2",
    ),
    "inputs": (
        "/processes/certificate/execution",
        f'{{"inputs": {{{START}}}, "inputs": {{{START}}}}}',
        "inputs",
    ),
    "a qualified input": (
        "/processes/certificate/execution",
        f'{{"inputs": {{{START}, "grid": {{"value": {{"nx": 5, "ny": 5}}}}, "a_max_m_s2": 0.2}}}}',
        "a_max_m_s2",
    ),
    "a grid in a grid": (
        "/processes/certificate/execution",
        f'{{"inputs": {{{START}, "grid": {{"nx": 5, "ny": 5, "nx": 7}}}}}}',
        "nx",
    ),
}


@pytest.mark.parametrize("name", TWICE)
def test_a_name_twice_in_a_body(client, name):
    path, body, field = TWICE[name]
    headers = {"Content-Type": "application/json"}
    problem = assert_problem(client.post(path, content=body, headers=headers), 422, field)
    assert "once" in problem["required"]


def test_the_same_name_in_two_objects_is_no_repetition(client):
    body = {**POINT, "states": [{"x_m": 5, "y_m": 40}] * 2}
    assert client.post("/go-no-go", json=body).status_code == 200


@pytest.mark.parametrize(
    ("path", "field"),
    [
        ("/jobs?limit=1&limit=200", "limit"),
        ("/jobs?limit=1&limit=1", "limit"),
        ("/jobs?submitter=a&submitter=b", "submitter"),
        ("/jobs?datetime=../2026-01-01T00:00:00Z&datetime=2026-01-01T00:00:00Z/..", "datetime"),
        ("/jobs?minDuration=1&minDuration=2", "minDuration"),
        ("/jobs?cursor=&cursor=", "cursor"),
        ("/jobs/x?wait=0&wait=30", "wait"),
        ("/jobs/x/results?format=csv&format=npz", "format"),
        ("/jobs/x/results?table=a&table=b", "table"),
        ("/jobs/x/artifacts/y/arrays?names=a&names=b", "names"),
        ("/processes?limit=1&limit=2", "limit"),
        ("/processes?offset=1&%6fffset=2", "offset"),
        ("/go-no-go?omega_t_deg_s=3&omega_t_deg_s=4&a_max_m_s2=0.1&x_m=5&y_m=40", "omega_t_deg_s"),
    ],
)
def test_a_parameter_twice(client, path, field):
    assert_problem(client.get(path), 422, field)


def test_lists_in_queries_are_repeated(client):
    found = client.get(
        "/jobs?status=failed&status=dismissed&processID=sweep&processID=benchmark&type=process"
    )
    assert found.status_code == 200


@pytest.mark.parametrize(
    "name",
    ["Idempotency-Key", "Authorization", "X-API-Key", "Content-Type", "Content-Length", "Last-Event-ID"],
)
def test_a_line_twice(client, name):
    values = {"Content-Type": "application/json", "Content-Length": "2"}
    lines: Any = [(name, values.get(name, value)) for value in ("a", "b")]
    body = json.dumps(HEAVY)
    if name != "Content-Type":
        lines.append(("Content-Type", "application/json"))
    answer = client.post("/processes/benchmark/execution", content=body, headers=lines)
    problem = assert_problem(answer, 400, name)
    assert problem["type"].endswith("malformed-request")
    assert client.get("/jobs").json()["jobs"] == []

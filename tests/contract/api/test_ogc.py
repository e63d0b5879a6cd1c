"""OGC API - Processes 1.0: each document as the standard has it, and the conformance that is claimed."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safestart_service.documents.dialects import common
from tests.contract.api import ogc_schemas
from tests.contract.api.service_client import HEAVY, finish, jobs_of, service, submit

FORMATS = jsonschema.FormatChecker()


def conforms(document: Any, schema: dict[str, Any]) -> None:
    jsonschema.Draft202012Validator(schema, format_checker=FORMATS).validate(document)


@pytest.fixture(scope="module")
def setting(tmp_path_factory):
    """A service with jobs in every state but running, and the id of the successful one."""
    folder: Path = tmp_path_factory.mktemp("ogc")
    with service(folder) as client:
        jobs = jobs_of(folder)
        done = submit(client)
        finish(jobs)
        submit(client)
        claim = jobs.claim("tester", 60.0)
        jobs.fail(claim, {"type": "about:blank", "title": "Broken", "status": 500, "detail": "it broke"})
        client.delete(f"/jobs/{submit(client)}")
        submit(client)
        yield client, done


def test_documents_conform(setting):
    client, done = setting
    conforms(client.get("/").json(), ogc_schemas.LANDING)
    conforms(client.get("/conformance").json(), ogc_schemas.CONFORMANCE)
    conforms(client.get("/processes").json(), ogc_schemas.PROCESS_LIST)
    listed = client.get("/jobs").json()
    conforms(listed, ogc_schemas.JOB_LIST)
    assert {job["status"] for job in listed["jobs"]} == {"successful", "failed", "dismissed", "accepted"}
    for job in listed["jobs"]:
        conforms(client.get(f"/jobs/{job['jobID']}").json(), ogc_schemas.STATUS_INFO)
    results = client.get(f"/jobs/{done}/results", headers={"Accept": "application/json"}).json()
    conforms(results, ogc_schemas.RESULTS)
    assert results["rows"][0]["engine"] == "analytical"
    assert results["map.png"]["type"] == "image/png"
    conforms(client.post("/processes/benchmark/execution", json=HEAVY).json(), ogc_schemas.STATUS_INFO)
    for path in ("/jobs/nope", "/processes/nope", "/nope", "/jobs?limit=0"):
        conforms(client.get(path).json(), ogc_schemas.EXCEPTION)


def test_answers_at_once_conform(setting):
    client, _ = setting
    for entry in client.get("/processes").json()["processes"]:
        if "sync-execute" in entry["jobControlOptions"]:
            url = f"/processes/{entry['id']}"
            example = client.get(url).json()["example"]
            conforms(client.post(f"{url}/execution", json={"inputs": example}).json(), ogc_schemas.RESULTS)


def test_a_list_links_to_itself_with_its_query(setting):
    client, _ = setting
    for url in ("/jobs", "/jobs?limit=2&status=accepted", "/processes?limit=3"):
        links = client.get(url).json()["links"]
        assert [link["href"] for link in links if link["rel"] == "self"] == [f"http://127.0.0.1{url}"]


def test_descriptions_conform(setting):
    client, _ = setting
    for entry in client.get("/processes").json()["processes"]:
        described = client.get(f"/processes/{entry['id']}").json()
        conforms(described, ogc_schemas.PROCESS)
        for field in (*described["inputs"].values(), *described["outputs"].values()):
            jsonschema.Draft202012Validator.check_schema(field["schema"])


def test_claims(setting):
    client, _ = setting
    claimed = {name.rpartition("/")[2] for name in client.get("/conformance").json()["conformsTo"]}
    assert claimed == {
        "core",
        "ogc-process-description",
        "json",
        "oas30",
        "job-list",
        "dismiss",
        "provenance",
    }
    assert client.get("/openapi-3.0.json").json()["openapi"].startswith("3.0"), (
        "what the class oas30 is about"
    )


@given(st.sampled_from(["exclusiveMinimum", "exclusiveMaximum"]), st.floats(-1e6, 1e6), st.floats(-1e6, 1e6))
def test_bounds_mean_the_same_in_both_dialects(side, bound, value):
    schema = {"type": "number", side: bound}
    for number in (value, bound, math.nextafter(bound, math.inf), math.nextafter(bound, -math.inf)):
        assert _valid(number, schema) == _valid(number, common(schema))


@given(st.sampled_from(["exclusiveMinimum", "exclusiveMaximum"]), st.integers(-50, 50), st.integers(-60, 60))
def test_integer_bounds_mean_the_same(side, bound, value):
    schema = {"type": "integer", side: bound}
    assert _valid(value, schema) == _valid(value, common(schema))


@pytest.mark.parametrize("value", [None, 3, "x", [1, 2], [1, 2, 3], {"const": 1}])
def test_other_words_mean_the_same(value):
    schema = {
        "anyOf": [
            {"type": "null"},
            {"const": 3},
            {"type": "array", "prefixItems": [{"type": "integer"}] * 2, "minItems": 2, "maxItems": 2},
            {
                "type": "object",
                "properties": {"const": {"type": "integer", "examples": [1]}},
                "required": ["const"],
            },
        ]
    }
    assert _valid(value, schema) == _valid(value, common(schema))
    assert "const" not in json.dumps(common(schema["anyOf"][1]))


def _valid(value: Any, schema: Any) -> bool:
    return bool(jsonschema.Draft202012Validator(schema).is_valid(value))

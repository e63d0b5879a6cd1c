"""The API description as generators of clients need it, in OpenAPI 3.1 and 3.0."""

from __future__ import annotations

import json
import re

import pytest
from openapi_spec_validator import validate

from tests.contract.api.service_client import BASE, service
from tools.openapi import render

DOCUMENT = json.loads(render())
TWO_SUCCESSES = {"execute": ["200", "201"], "getEvents": ["200", "204"]}
"""The standard answers an execution in two ways; an event stream that has nothing more to say tells so."""


@pytest.fixture(scope="module")
def descriptions(tmp_path_factory):
    """What a service gives: 3.1 and 3.0."""
    with service(tmp_path_factory.mktemp("described")) as client:
        return [client.get(path).json() for path in ("/openapi.json", "/openapi-3.0.json")]


def operations(document):
    return [operation for methods in document["paths"].values() for operation in methods.values()]


def test_names_are_ours():
    schemas = DOCUMENT["components"]["schemas"]
    assert [name for name in schemas if not re.fullmatch(r"[A-Z][A-Za-z0-9]+", name)] == []
    assert not {"HTTPValidationError", "ValidationError"} & set(schemas), "FastAPI's, which nobody is sent"
    titles = [schema["title"] for schema in schemas.values()]
    assert len(set(titles)) == len(titles)
    names = [operation["operationId"] for operation in operations(DOCUMENT)]
    assert [name for name in names if not re.fullmatch(r"[a-z][A-Za-z]+", name)] == []
    assert len(set(names)) == len(names)
    tags = {tag["name"] for tag in DOCUMENT["tags"]}
    assert {tag for operation in operations(DOCUMENT) for tag in operation["tags"]} == tags


def test_bodies_of_several_models_have_names():
    """Generators name a class of an unnamed one after the first call that takes it: a new call changed that name."""
    bodies = {
        operation["operationId"]: operation["requestBody"]["content"]["application/json"]["schema"]
        for operation in operations(DOCUMENT)
        if "requestBody" in operation
    }
    assert all(list(schema) == ["$ref"] for schema in bodies.values())
    names = {name: schema["$ref"].rsplit("/", 1)[1] for name, schema in bodies.items()}
    assert names["execute"] == names["estimate"] == "ExecuteRequest"
    assert names["goNoGoMany"] == "GoNoGoRequest"
    assert len(DOCUMENT["components"]["schemas"]["ExecuteRequest"]["anyOf"]) > 20


def test_one_success_for_each_call():
    for operation in operations(DOCUMENT):
        successes = [status for status in operation["responses"] if status.startswith("2")]
        assert successes == TWO_SUCCESSES.get(operation["operationId"], successes[:1]), operation[
            "operationId"
        ]


def test_it_names_the_service_that_gives_it(descriptions):
    assert [document["servers"][0]["url"] for document in descriptions] == [BASE, BASE]
    assert DOCUMENT["servers"][0]["url"] == "http://127.0.0.1:8000"


def test_openapi_3_0_says_the_same(descriptions):
    new, old = descriptions
    validate(old)
    assert old["openapi"].startswith("3.0.")
    assert [op["operationId"] for op in operations(old)] == [op["operationId"] for op in operations(new)]
    assert list(old["components"]["schemas"]) == list(new["components"]["schemas"])
    text = json.dumps(old)
    for word in ('"prefixItems"', '"const"', '"type": "null"', '"examples": ['):
        assert word not in text, word
    point = old["components"]["schemas"]["CorridorInput"]["properties"]
    assert all(isinstance(field.get("exclusiveMinimum", True), bool) for field in point.values())
    space = old["components"]["schemas"]["SpaceInputs"]["properties"]
    assert space["attitude"]["nullable"] is True
    assert space["attitude"]["type"] == "object"

"""Problem documents: complete for every error, JSON whatever was received, silent about the inside."""

from __future__ import annotations

import asyncio
import json

import pytest
from starlette.requests import ClientDisconnect

from safestart import errors
from safestart_service import errors as service_errors
from safestart_service.documents import problems
from safestart_service.http.limits import Limits

MEMBERS = {"type", "title", "status", "detail", "instance", "field", "required", "received", "request_id"}


def _kinds() -> list[type[errors.SafestartError]]:
    kinds = [errors.SafestartError]
    for module in (errors, service_errors):
        kinds += [
            k for k in vars(module).values() if isinstance(k, type) and issubclass(k, errors.SafestartError)
        ]
    return list(dict.fromkeys(kinds))


@pytest.mark.parametrize("kind", _kinds())
def test_every_error_is_a_problem(kind):
    problem = problems.of_error(kind("it broke", field="x_m", required="less", received=3), "/here", "id-1")
    assert set(problem) == MEMBERS
    assert problem["status"] == kind.status
    assert problem["type"].endswith(kind.slug)
    assert 400 <= kind.status < 600
    json.loads(problems.encode(problem))


@pytest.mark.parametrize(
    "received",
    [
        float("nan"),
        float("inf"),
        10**400,
        10**5000,
        "\ud800",
        "x" * 10_000,
        b"\xff",
        {1: 2},
        [None] * 1000,
        object(),
    ],
    ids=lambda value: type(value).__name__,
)
def test_anything_received_can_be_shown(received):
    problem = problems.document("s", "t", 422, "d", "/", received=received)
    shown = json.loads(problems.encode(problem))["received"]
    assert len(str(shown)) <= problems.MAX_SHOWN


def test_ogc_types():
    assert problems.type_uri("no-such-job").startswith("http://www.opengis.net/def/exceptions/")
    assert problems.type_uri("invalid-input") == "urn:safestart:problem:invalid-input"


def _call(app, **scope):
    """Messages that Limits(app) sends for a GET."""
    sent = []

    async def receive():
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message):
        sent.append(message)

    base = {"type": "http", "method": "GET", "path": "/p", "query_string": b"", "headers": []}
    return sent, Limits(app, 1000)(base | scope, receive, send)


def test_unexpected_errors_leak_nothing(caplog):
    async def broken(scope, receive, send):
        raise ZeroDivisionError("secret of the inside")

    sent, call = _call(broken)
    asyncio.run(call)
    assert sent[0]["status"] == 500
    assert b"secret" not in sent[1]["body"]
    (record,) = caplog.records
    assert json.loads(sent[1]["body"])["request_id"] in str(vars(record))
    assert "secret" in caplog.text, "the log has what the answer has not"


def test_an_answer_that_began_is_cut():
    async def broken(scope, receive, send):
        await send({"type": "http.response.start", "status": 200, "headers": []})
        raise ZeroDivisionError

    sent, call = _call(broken)
    with pytest.raises(ZeroDivisionError):
        asyncio.run(call)
    assert [message["type"] for message in sent] == ["http.response.start"]


def test_a_caller_who_leaves_is_no_error(caplog):
    async def waiting(scope, receive, send):
        raise ClientDisconnect

    sent, call = _call(waiting)
    asyncio.run(call)
    assert sent == []
    assert not [record for record in caplog.records if record.levelname == "ERROR"]


@pytest.mark.parametrize("length", [b"1001", b"-1", b"x", b"9" * 30])
def test_declared_length(length):
    async def never(scope, receive, send):
        raise AssertionError("the body must not be read")

    sent, call = _call(never, headers=[(b"content-length", length)])
    asyncio.run(call)
    assert sent[0]["status"] == 413
    assert json.loads(sent[1]["body"])["field"] == "body"

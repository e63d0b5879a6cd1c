"""A header field that is a list may come in several lines, all of which count (RFC 9110, 5.3)."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.contract.api.service_client import POINT, assert_problem, finish, submit
from tests.contract.server.raw_http import HOST, problem_in, said

JSON = ("Content-Type", "application/json")


def lines(name: str, *values: str) -> Any:
    return [(name, value) for value in values]


@pytest.mark.parametrize(
    "codings",
    [
        ("identity", "gzip"),
        ("gzip", "identity"),
        ("", "br"),
        ("identity, gzip",),
        ("identity", "identity,, x"),
    ],
)
def test_a_body_is_as_coded_as_all_lines_say(client, codings):
    headers = [JSON, *lines("Content-Encoding", *codings)]
    answer = client.post("/certificates", content=json.dumps(POINT), headers=headers)
    assert_problem(answer, 415, "Content-Encoding")


def test_a_body_without_a_coding_may_say_so_twice(client):
    headers = [JSON, *lines("Content-Encoding", "identity", "Identity, ")]
    assert client.post("/certificates", content=json.dumps(POINT), headers=headers).status_code == 200


@pytest.mark.parametrize("tags", [('"x"', "{}"), ("{}", '"x"'), ('"x"', 'W/{}, "y"'), ('"x"', "*")])
def test_every_line_of_known_tags(client, tags):
    tag = client.get("/processes").headers["etag"]
    headers = lines("If-None-Match", *(text.format(tag) for text in tags))
    assert client.get("/processes", headers=headers).status_code == 304


def test_every_line_of_accept(client):
    page = client.get("/", headers=lines("Accept", "image/png", "text/html"), follow_redirects=False)
    assert page.status_code == 303
    missing = client.get("/nowhere", headers=lines("Accept", "image/png", "text/html"))
    assert missing.headers["content-type"].startswith("text/html")


def test_every_line_of_accept_for_results(queue):
    """What one line excludes another may ask for: refused is only what none of them accepts."""
    client, jobs = queue
    job = submit(client)
    finish(jobs)
    path = f"/jobs/{job}/results"
    found = client.get(path, headers=lines("Accept", "image/png", "text/csv"))
    assert found.headers["content-type"].startswith("text/csv")
    assert client.get(path, headers=lines("Accept", "image/png", "image/gif")).status_code == 406


@pytest.mark.parametrize("preferences", [("respond-async", "wait=10"), ("wait=10", "respond-async")])
def test_every_line_of_prefer(queue, preferences):
    client, _ = queue
    headers = [JSON, *lines("Prefer", *preferences)]
    answer = client.post(
        "/processes/certificate/execution", content=json.dumps({"inputs": POINT}), headers=headers
    )
    assert answer.status_code == 201


def test_of_two_request_ids_neither_counts(client):
    """One log would have the request under the first, another under the last."""
    assert client.get("/healthz", headers={"X-Request-ID": "a"}).headers["x-request-id"] == "a"
    for twice in (("a", "b"), ("a", "a"), ("a", "b", "c")):
        given = client.get("/healthz", headers=lines("X-Request-ID", *twice)).headers["x-request-id"]
        assert given not in twice


CHUNKS = b"2\r\n{}\r\n0\r\n\r\n"
NEXT = b"GET /healthz HTTP/1.1\r\n" + HOST + b"\r\n"
OFFER = b"Connection: upgrade\r\nUpgrade: h2c\r\n"


def coded(*codings: bytes, more: bytes = b"", version: bytes = b"1.1") -> bytes:
    head = (
        b"POST /certificates HTTP/" + version + b"\r\n" + HOST + b"Content-Type: application/json\r\n" + more
    )
    return head + b"".join(b"Transfer-Encoding: %s\r\n" % coding for coding in codings) + b"\r\n" + CHUNKS


@pytest.mark.parametrize("more", [b"", OFFER])
@pytest.mark.parametrize(
    "codings",
    [
        (b"gzip, chunked",),
        (b"gzip", b"chunked"),
        (b"deflate,gzip,chunked",),
        (b"identity, chunked",),
        (b"x;y=1, Chunked",),
    ],
)
def test_a_transfer_coding_that_nobody_undoes(address, codings, more):
    """The body would be read as it came. Nothing behind it is read: where it ends is the sender's word alone."""
    told = said(address, coded(*codings, more=more) + NEXT)
    problem = problem_in(told, 501)
    assert problem["field"] == "Transfer-Encoding"
    assert problem["required"] == "chunked"


@pytest.mark.parametrize(
    "codings",
    [(b"chunked, gzip",), (b"chunked", b"chunked"), (b"chunked, chunked",), (b"gzip",), (b"chunked;q=1",)],
)
def test_a_body_without_an_end(address, codings):
    problem_in(said(address, coded(*codings)), 400)


def test_chunks_in_http_1_0(address):
    """A proxy of that age takes them for something else (RFC 9112, 6.1)."""
    assert problem_in(said(address, coded(b"chunked", version=b"1.0")), 400)["field"] == "Transfer-Encoding"


def test_chunks_alone(address):
    for coding in (b"chunked", b" CHUNKED ", b", chunked"):
        told = said(address, coded(coding) + NEXT.replace(b"\r\n\r\n", b"\r\nConnection: close\r\n\r\n"))
        assert [part[:3] for part in told.split(b"HTTP/1.1 ")[1:]] == [b"422", b"200"], told

"""Bytes that are not a proper request: a real server answers with a problem document in time, and keeps running."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest

from tests.contract.server.raw_http import HOST, problem_in, said

POST = b"POST /certificates HTTP/1.1\r\n" + HOST + b"Content-Type: application/json\r\n"
NO_HTTP = {
    "noise": b"\x16\x03\x01\x02\x00\x01\x00\r\n\r\n",
    "no slash": b"GET jobs HTTP/1.1\r\n" + HOST + b"\r\n",
    "space in path": b"GET /health z HTTP/1.1\r\n" + HOST + b"\r\n",
    "raw UTF-8 in path": "GET /jobs/é HTTP/1.1\r\n\r\n".encode(),
    "unknown method": b"B@D / HTTP/1.1\r\n" + HOST + b"\r\n",
    "unknown version": b"GET / HTTP/9.9\r\n" + HOST + b"\r\n",
    "HTTP/2 preface": b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
    "bare LF": b"GET / HTTP/1.1\nHost: localhost\n\n",
    "header without colon": b"GET / HTTP/1.1\r\n" + HOST + b"banana\r\n\r\n",
    "NUL in header": b"GET / HTTP/1.1\r\n" + HOST + b"X-A: \x00\r\n\r\n",
    "folded header": b"GET / HTTP/1.1\r\n" + HOST + b"X-A: 1\r\n 2\r\n\r\n",
    "negative length": POST + b"Content-Length: -1\r\n\r\n",
    "two lengths": POST + b"Content-Length: 2\r\nContent-Length: 5\r\n\r\n{}",
    "length and chunks": POST
    + b"Content-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\nGET / HTTP/1.1\r\n\r\n",
    "bad chunk": POST + b"Transfer-Encoding: chunked\r\n\r\nZZ\r\n{}\r\n0\r\n\r\n",
    "fragment": b"GET /go-no-go?omega_t_deg_s=3&a_max_m_s2=0.1&x_m=5&y_m=40#&disturbance_m_s2=0.05 HTTP/1.1\r\n"
    + HOST
    + b"\r\n",
    "fragment before a body": b"POST /certificates#a HTTP/1.1\r\n" + HOST + b"Content-Length: 2\r\n\r\n{}",
    "empty fragment": b"GET /healthz# HTTP/1.1\r\n" + HOST + b"\r\n",
    "endless path": b"GET /" + b"a" * 70_000 + b" HTTP/1.1\r\n" + HOST + b"\r\n",
}


@pytest.mark.parametrize("name", NO_HTTP)
def test_what_is_no_http(address, name):
    assert problem_in(said(address, NO_HTTP[name]), 400)["type"].endswith("malformed-request")
    assert said(address, b"GET /healthz HTTP/1.0\r\n\r\n").startswith(b"HTTP/1.1 200 ")


def test_a_head_that_does_not_end_in_time(address):
    problem = problem_in(said(address, b"GET /healthz HTTP/1.1\r\nX-A: 1\r\n"), 408)
    assert problem["field"] == "headers"


def test_nothing_asked_nothing_answered(address):
    """A connection is not held open for nothing, neither a new one nor one that was answered."""
    asked = b"GET /healthz HTTP/1.1\r\n" + HOST + b"\r\n"
    silences: list[tuple[bytes, ...]] = [(b"",), (b"\r\n\r\n",), (asked, b""), (asked, b"\r\n\r\n")]
    with ThreadPoolExecutor() as pool:
        found = list(pool.map(lambda pieces: said(address, *pieces), silences))
    assert found[:2] == [b"", b""]
    for answer in found[2:]:
        assert answer.startswith(b"HTTP/1.1 200 ")
        assert answer.count(b"HTTP/1.1 ") == 1


def test_a_head_without_end(address):
    """It is cut off, although it comes fast; data still unsent at the close may cost us the answer."""
    found = said(address, b"GET /healthz HTTP/1.1\r\nX-A: ", *[b"a" * 65_536] * 64)
    if found:
        assert problem_in(found, 431)["field"] == "headers"


def test_no_answer_takes_the_place_of_another(address):
    """Noise behind a request that is not answered yet: the answer to the noise must not be taken for the first one."""
    found = said(address, b"GET /healthz HTTP/1.1\r\n" + HOST + b"\r\n\x00\x01\r\n\r\n")
    assert found == b"" or found.startswith(b"HTTP/1.1 200 ")


def test_ordinary_heads_of_every_age(address):
    """HTTP/1.0 without Host, an upgrade that is not offered, many headers, requests in a row on one connection."""
    many = b"".join(b"X-%d: 1\r\n" % i for i in range(1000))
    upgrade = b"Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Key: AAAA\r\nSec-WebSocket-Version: 13\r\n"
    heads = [b"GET /healthz HTTP/1.1\r\n" + HOST + more + b"\r\n" for more in (b"", many, upgrade)]
    heads.append(b"GET /healthz HTTP/1.0\r\n\r\n")
    with ThreadPoolExecutor() as pool:
        for answer in pool.map(lambda head: said(address, head), heads):
            assert answer.startswith(b"HTTP/1.1 200 ")
    asked = b"GET /healthz HTTP/1.1\r\n" + HOST
    three = (asked + b"\r\n") * 2 + asked + b"Connection: close\r\n\r\n"
    assert said(address, three).count(b"HTTP/1.1 200 ") == 3


def test_without_host(address):
    """RFC 9112: a request of HTTP/1.1 without Host is refused with 400; HTTP/1.0 knows none."""
    for host in (b"", b"Host:\r\n", b"Host: [::1]:99999\r\n"):
        told = said(address, b"GET /healthz HTTP/1.1\r\n" + host + b"Connection: close\r\n\r\n")
        problem = problem_in(told, 400)
        assert problem["field"] == "Host"


ABSOLUTE = b"GET http://%s/healthz HTTP/1.1\r\nHost: %s\r\nConnection: close\r\n\r\n"


@pytest.mark.parametrize(
    ("target", "host"),
    [
        (b"evil.example", b"localhost"),
        (b"localhost", b"127.0.0.1"),
        (b"localhost:81", b"localhost"),
        (b"user@localhost", b"localhost"),
        (b"localhost", b"evil.example"),
    ],
)
def test_a_target_and_a_host_that_differ_are_two_hosts(address, target, host):
    """RFC 9112: a proxy reads the host of the target, the application the field."""
    assert problem_in(said(address, ABSOLUTE % (target, host)), 400)["field"] == "Host"


def test_a_target_that_names_the_host_again(address):
    for target, host in (
        (b"localhost", b"localhost"),
        (b"LOCALHOST:80", b"localhost"),
        (b"[::1]:99", b"[::1]:99"),
    ):
        assert said(address, ABSOLUTE % (target, host)).startswith(b"HTTP/1.1 200")
    old = b"GET http://%s/healthz HTTP/1.0\r\n\r\n"
    assert said(address, old % b"localhost").startswith(b"HTTP/1.1 200")
    problem_in(said(address, old % b"evil.example"), 421)

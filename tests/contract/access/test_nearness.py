"""Which callers count as being on this machine while no keys exist."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import httpx
import pytest
from starlette.testclient import TestClient

from safestart_service.access.nearness import from_this_machine
from tests.contract.api.service_client import BASE, HEAVY, assert_problem, url_of
from tests.waiting import PATIENCE_S

STRANGERS = [
    ("X-Forwarded-For", "203.0.113.5"),
    ("X-Forwarded-For", "unknown"),
    ("X-Forwarded-For", "_hidden"),
    ("X-Forwarded-For", "localhost"),
    ("X-Forwarded-For", "evil.example"),
    ("X-Forwarded-For", "203.0.113.5,"),
    ("X-Forwarded-For", "127.0.0.1,"),
    ("X-Forwarded-For", ",127.0.0.1"),
    ("X-Forwarded-For", ""),
    ("X-Forwarded-For", "203.0.113.5, 127.0.0.1"),
    ("X-Forwarded-For", "127.0.0.1:x"),
    ("X-Forwarded-For", "[::1"),
    ("X-Forwarded-For", "0.0.0.0"),
    ("X-Forwarded-For", "127.1"),
    ("X-Real-IP", "203.0.113.5"),
    ("X-Real-IP", "unknown"),
    ("CF-Connecting-IP", "203.0.113.5"),
    ("True-Client-IP", "203.0.113.5"),
    ("Forwarded", "for=203.0.113.5"),
    ("Forwarded", "for=unknown"),
    ("Forwarded", "for=_hidden;proto=http"),
    ("Forwarded", 'For="[2001:db8::1]:4711"'),
    ("Forwarded", "for=127.0.0.1, for=203.0.113.5"),
    ("Forwarded", "for=127.0.0.1;for=203.0.113.5"),
    ("Forwarded", "for=203.0.113.5;for=127.0.0.1"),
    ("Forwarded", "proto=https"),
    ("Forwarded", "for=127.0.0.1,"),
    ("Forwarded", 'for="127.0.0.1'),
    ("Forwarded", 'by="a,for=127.0.0.1"'),
    ("Forwarded", ""),
    ("X-Forwarded", "for=203.0.113.5"),
    ("Forwarded-For", "203.0.113.5"),
    ("Client-IP", "203.0.113.5"),
    ("X-Azure-ClientIP", "203.0.113.5"),
    ("CF-Connecting-IPv6", "2001:db8::1"),
    ("Via", "1.1 proxy"),
    ("Via", "1.1 localhost"),
    ("Via", ""),
    ("CDN-Loop", "cloudflare"),
    ("X-Forwarded-For", "127.0.0.1%eth0"),
    ("X-Forwarded-For", "::1%8.8.8.8"),
    ("X-Forwarded-For", "[::1%1]:80"),
    ("X-Forwarded-For", "[::1]:99999"),
    ("X-Forwarded-For", "127.0.0.1:65536"),
    ("Forwarded", 'for="[::1%25eth0]"'),
    ("Proxy-Client-IP", "203.0.113.5"),
    ("WL-Proxy-Client-IP", "203.0.113.5"),
    ("X-ProxyUser-Ip", "203.0.113.5"),
    ("X-Vercel-Forwarded-For", "203.0.113.5"),
    ("DO-Connecting-IP", "203.0.113.5"),
    ("Incap-Client-IP", "203.0.113.5"),
    ("X_Forwarded_For", "203.0.113.5"),
    ("X_Real_IP", "203.0.113.5"),
    ("X-Forwarded-Server", "proxy.example"),
    ("X-Forwarded-Port", "443"),
    ("X-Forwarded-By", "127.0.0.1"),
    ("Proxy-Connection", "keep-alive"),
    ("X-Original-Host", "safestart.example"),
    ("CF-Ray", "8f0000000000-FRA"),
    ("X-Amz-Cf-Id", "x"),
    ("X-Azure-Ref", "x"),
    ("Forwarded", "for=127.0.0.1;8.8.8.8"),
    ("Forwarded", "8.8.8.8;for=127.0.0.1"),
    ("X-Forward-For", "8.8.8.8"),
    ("X-Coming-From", "8.8.8.8"),
    ("X-Client", "8.8.8.8"),
    ("X-Tunnel-Client", "8.8.8.8"),
    ("X-Real-Port", "4711"),
    ("Surrogate-Capability", "a=ESI/1.0"),
]
NEIGHBOURS = [
    ("X-Forwarded-For", "127.0.0.1"),
    ("X-Forwarded-For", "127.0.0.2:4711, [::1]:80, ::1"),
    ("X-Forwarded-For", "::ffff:127.0.0.1"),
    ("X-Real-IP", "::1"),
    ("Forwarded", "for=127.0.0.1"),
    ("Forwarded", 'proto=http;for="[::1]:4711";by="a,b;c", FOR = 127.0.0.1'),
    ("X-Forwarded-Proto", "https"),
    ("X-Forwarded", "for=127.0.0.1"),
    ("Forwarded-For", "127.0.0.1"),
    ("X-Forwarded-For", "[::1]:65535"),
    ("X-Forwarded-Host", "localhost"),
    ("X-Client-Data", "of a browser"),
]
BROWSER = {
    "sec-ch-ua": '"Chromium";v="130", "Not?A_Brand";v="99"',
    "sec-ch-ua-mobile": "?0",
    "sec-ch-ua-platform": '"Linux"',
    "Upgrade-Insecure-Requests": "1",
    "Sec-Fetch-Site": "same-origin",
    "Sec-Fetch-Mode": "navigate",
    "Sec-Fetch-User": "?1",
    "Sec-Fetch-Dest": "document",
    "Sec-Purpose": "prefetch",
    "Priority": "u=0, i",
    "DNT": "1",
    "Sec-GPC": "1",
    "TE": "trailers",
    "If-None-Match": '"x"',
    "Cookie": "via=1; x-forwarded-for=203.0.113.5",
    "Last-Event-ID": "1",
}


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    """A server as `safestart serve` starts it, without keys."""
    where = ["--port", "0", "--database-url", url_of(tmp_path_factory.mktemp("near"))]
    command = [sys.executable, "-m", "safestart_service", *where]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    yield process.stdout.readline().split()[1]
    process.terminate()
    process.wait(PATIENCE_S)


@pytest.mark.parametrize(("name", "value"), STRANGERS)
def test_who_comes_through_a_proxy_is_a_stranger(base, name, value):
    with httpx.Client(base_url=base, timeout=PATIENCE_S, headers={name: value}) as client:
        assert_problem(client.get("/jobs"), 401)
        assert_problem(client.post("/processes/benchmark/execution", json=HEAVY), 401)
        assert client.get("/healthz").status_code == 200


@pytest.mark.parametrize(
    ("name", "value"),
    [
        (b"x-forwarded-for", b"\xa0127.0.0.1"),
        (b"x-real-ip", b"127.0.0.1\x85"),
        (b"forwarded", b"for=\xa0127.0.0.1"),
    ],
)
def test_only_spaces_and_tabs_are_space(name, value):
    scope: dict[str, Any] = {"client": ("127.0.0.1", 1), "server": ("127.0.0.1", 80)}
    assert not from_this_machine({**scope, "headers": [(name, value)]})
    assert from_this_machine({**scope, "headers": [(name, value.strip(b"\xa0\x85").replace(b"\xa0", b"\t"))]})


@pytest.mark.parametrize(("name", "value"), NEIGHBOURS)
def test_who_comes_through_a_proxy_from_here_is_a_neighbour(base, name, value):
    with httpx.Client(base_url=base, timeout=PATIENCE_S, headers={name: value}) as client:
        assert client.get("/jobs").status_code == 200


def test_a_browser_on_this_machine_is_a_neighbour(base):
    assert httpx.get(f"{base}/jobs", headers=BROWSER, timeout=PATIENCE_S).status_code == 200


def test_a_proxy_here_that_says_all_about_itself_names_its_client(base):
    said = {"X-Forwarded-Host": "localhost", "X-Forwarded-Server": "localhost", "X-Forwarded-Port": "80"}
    for client, status in (("127.0.0.1", 200), ("203.0.113.5", 401)):
        headers = {**said, "X-Forwarded-For": client}
        assert httpx.get(f"{base}/jobs", headers=headers, timeout=PATIENCE_S).status_code == status


def test_one_of_two_lines_names_a_stranger(base):
    for lines in (("127.0.0.1", "203.0.113.5"), ("203.0.113.5", "127.0.0.1")):
        headers = [("X-Forwarded-For", line) for line in lines]
        assert_problem(httpx.get(f"{base}/jobs", headers=headers, timeout=PATIENCE_S), 401)


@pytest.mark.parametrize("address", ["testclient", "unknown", "_hidden", "", "203.0.113.5"])
def test_an_application_elsewhere_trusts_no_name(client, address):
    """What embeds the application may put anything into the scope."""
    odd = TestClient(client.app, base_url=BASE, client=(address, 1))
    assert_problem(odd.get("/jobs"), 401)
    assert_problem(
        TestClient(client.app, client=("127.0.0.1", 1), base_url="http://x.localhost").get("/jobs"), 401
    )


def test_the_ends_of_a_socket():
    def near(client: Any, server: Any) -> bool:
        return from_this_machine({"client": client, "server": server, "headers": []})

    here, there = ("127.0.0.1", 1), ("203.0.113.5", 1)
    assert near(here, here)
    assert near(None, ("/run/safestart.sock", None)), "a Unix socket"
    assert not near(there, ("/run/safestart.sock", None))
    assert not any(
        (near(None, here), near(here, None), near(None, None), near(there, here), near(here, there))
    )

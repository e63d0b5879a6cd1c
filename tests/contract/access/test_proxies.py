"""Below a path and behind proxies: which words of a proxy count, and that every link follows them."""

from __future__ import annotations

import json
import re
from contextlib import ExitStack
from functools import cache
from itertools import chain
from typing import Any
from urllib.parse import urlsplit

import pytest
from starlette.testclient import TestClient

from safestart.errors import InvalidInput
from safestart.runtime.settings import Settings
from safestart_service.app import create_app
from tests.contract.api.service_client import (
    BASE,
    HEAVY,
    POINT,
    assert_problem,
    finish,
    jobs_of,
    service,
    submit,
    url_of,
)

ASK = {**POINT, "x_m": 5, "y_m": 40}
LONG = "/" + "a" * 200
SAID = {
    "X-Forwarded-Proto": "https",
    "X-Forwarded-Host": "safestart.example:8443",
    "X-Forwarded-Prefix": "/safestart",
}
OUTSIDE = "https://safestart.example:8443/safestart"
NAMED: dict[str, Any] = {"allowed_hosts": "safestart.example"}


def addresses(document: Any) -> list[str]:
    """Every link in a JSON document."""
    return re.findall(r'"(?:href|url|proof_url)":\s*"([^"]+)"', json.dumps(document))


@pytest.fixture(scope="module")
def at_root(tmp_path_factory):
    """Applications by their setting ``root_path``, each with one finished job, whose id comes with it."""
    with ExitStack() as stack:

        @cache
        def made(root: str) -> tuple[Any, str]:
            folder = tmp_path_factory.mktemp("proxies")
            client = stack.enter_context(service(folder, root_path=root, **NAMED))
            job = submit(client)
            finish(jobs_of(folder))
            return client.app, job

        yield made


@pytest.mark.parametrize(
    ("root", "before", "said", "base"),
    [
        ("", "", SAID, OUTSIDE),
        ("", "/safestart", SAID, OUTSIDE),
        ("", "", SAID | {"X-Forwarded-Prefix": "/safestart/"}, OUTSIDE),
        ("", "", {"X-Forwarded-Prefix": "/a/b.c"}, f"{BASE}/a/b.c"),
        ("", "", {"X-Forwarded-Prefix": "/"}, BASE),
        ("/safestart/", "", {}, f"{BASE}/safestart"),
        ("/safestart/", "/safestart", {}, f"{BASE}/safestart"),
        ("/safestart/", "/other", SAID | {"X-Forwarded-Prefix": "/other"}, f"{OUTSIDE[:-10]}/other"),
        ("/safestart/", "/safestart", {"X-Forwarded-Proto": "HTTPS"}, "https://127.0.0.1/safestart"),
    ],
)
def test_every_link_is_as_the_client_sees_it(at_root, root, before, said, base):
    """``before``: what the proxy has left before our paths."""
    app, job = at_root(root)
    below = urlsplit(base).path
    client = TestClient(app, base_url=BASE, client=("127.0.0.1", 1), headers=said)
    queued = client.post(f"{before}/processes/benchmark/execution", json=HEAVY)
    assert queued.headers["location"].startswith(f"{base}/jobs/")
    found = [addresses(queued.json())]
    for path in ("/", "/processes?limit=2&offset=2", "/processes/benchmark", "/jobs", f"/jobs/{job}"):
        answer = client.get(before + path)
        assert answer.status_code == 200, path
        found.append([link for link in addresses(answer.json()) if "opengis" not in link])
        assert found[-1], path
    for link in found[-1]:
        assert client.get(before + link.removeprefix(base)).status_code == 200, link
    files = [file["href"] for file in client.get(f"{before}/jobs/{job}/results").json()["artifacts"]]
    assert client.get(before + files[0].removeprefix(base)).status_code == 200
    for link in chain(files, *found):
        assert link == base or link.startswith(f"{base}/"), link
    page = client.get(f"{before}/dashboard").text
    assert all(ref.startswith(f"{below}/") for ref in re.findall(r'(?:href|src)="(/[^"]*)"', page)), page
    assert f'data-root="{below}"' in page
    sent = client.get(f"{before}/", headers={"Accept": "text/html"}, follow_redirects=False)
    assert (sent.status_code, sent.headers["location"]) == (303, f"{base}/dashboard")
    proof = client.get(f"{before}/go-no-go", params=ASK).json()["proof_url"]
    assert proof.startswith(f"{below}/go-no-go/proof?")
    old = client.get(f"{before}/go-no-go", params=ASK | {"method": "closed_form"})
    assert old.headers["link"].startswith(f"<{below}/docs>")
    many = {**POINT, "states": [{"x_m": 5, "y_m": 40}], "method": "closed_form"}
    assert client.post(f"{before}/go-no-go", json=many).headers["link"] == old.headers["link"]
    wrong = client.put(f"{before}/jobs")
    assert assert_problem(wrong, 405)["instance"] == f"{below}/jobs"
    assert "GET" in wrong.headers["allow"]


@pytest.mark.parametrize(
    ("name", "value", "status"),
    [
        ("X-Forwarded-Prefix", "//evil.example", 400),
        ("X-Forwarded-Prefix", "/a//evil.example", 400),
        ("X-Forwarded-Prefix", "https://evil.example", 400),
        ("X-Forwarded-Prefix", "javascript:alert(1)", 400),
        ("X-Forwarded-Prefix", "/../admin", 400),
        ("X-Forwarded-Prefix", "/a/./b", 400),
        ("X-Forwarded-Prefix", "/%2e%2e", 400),
        ("X-Forwarded-Prefix", "/a\\b", 400),
        ("X-Forwarded-Prefix", '/a"><script>', 400),
        ("X-Forwarded-Prefix", "/a b", 400),
        ("X-Forwarded-Prefix", "/a?b", 400),
        ("X-Forwarded-Prefix", "/a\r\nSet-Cookie: a=b", 400),
        ("X-Forwarded-Prefix", "/a\n", 400),
        ("X-Forwarded-Prefix", "/a, /b", 400),
        ("X-Forwarded-Prefix", "/ä", 400),
        ("X-Forwarded-Prefix", "safestart", 400),
        ("X-Forwarded-Prefix", LONG, 400),
        ("X-Forwarded-Prefix", "/jobs", 400),
        ("X-Forwarded-Prefix", "/static/x", 400),
        ("X-Forwarded-Proto", "javascript", 400),
        ("X-Forwarded-Proto", "https, http", 400),
        ("X-Forwarded-Proto", "", 400),
        ("X-Forwarded-Host", "evil.example", 421),
        ("X-Forwarded-Host", "safestart.example, evil.example", 400),
        ("X-Forwarded-Host", "safestart.example@evil.example", 400),
        ("X-Forwarded-Host", "safestart.example/x", 400),
        ("X-Forwarded-Host", "safestart.example\r\nX: y", 400),
        ("X-Forwarded-Host", "a" * 5000, 400),
        ("X-Forwarded-Host", "", 400),
    ],
)
def test_a_trusted_proxy_passes_nonsense_on(at_root, name, value, status):
    """A proxy that forwards what a stranger sent: refused, and nothing of it is in a header of the answer."""
    client = TestClient(at_root("")[0], base_url=BASE, client=("127.0.0.1", 1))
    for path in ("/", "/healthz", "/dashboard", "/jobs"):
        answer = client.get(path, headers={name: value.encode("latin-1")})
        problem = assert_problem(answer, status, name)
        assert "evil" not in str(answer.headers)
        assert len(problem["detail"]) < 500
    assert_problem(client.get("/", headers=[(name, "/a"), (name, "/b")]), 400, name)


@pytest.mark.parametrize(
    ("trusted", "peer"),
    [("", "127.0.0.1"), ("10.0.0.0/8", "127.0.0.1"), ("127.0.0.0/8, ::1", "203.0.113.9"), ("::1", "::2")],
)
def test_nobody_else_is_listened_to(tmp_path, trusted, peer):
    """Not even to be refused: whoever is no trusted proxy may say what they like."""
    with service(tmp_path, trusted_proxies=trusted, **NAMED) as client:
        other = TestClient(client.app, base_url=BASE, client=(peer, 1))
        plain = other.get("/").json()
        for said in (SAID, {"X-Forwarded-Prefix": "//evil.example", "X-Forwarded-Host": "evil.example"}):
            assert other.get("/", headers=said).json() == plain
            assert 'data-root=""' in other.get("/dashboard", headers=said).text


@pytest.mark.parametrize(
    ("trusted", "peer", "nodes", "client"),
    [
        ("127.0.0.0/8", "127.0.0.1", "203.0.113.5", "203.0.113.5"),
        ("127.0.0.0/8", "127.0.0.1", "198.51.100.1, 203.0.113.5", "203.0.113.5"),
        ("127.0.0.0/8, 10.0.0.0/8", "127.0.0.1", "203.0.113.5:4711, 10.1.2.3", "203.0.113.5"),
        ("127.0.0.0/8", "::ffff:127.0.0.1", "[2001:db8::1]:80", "2001:db8::1"),
        ("127.0.0.0/8", "127.0.0.1", "unknown", "127.0.0.1"),
        ("127.0.0.0/8", "127.0.0.1", "203.0.113.5,", "127.0.0.1"),
        ("10.0.0.0/8", "10.0.0.5", "127.0.0.1", "10.0.0.5"),
        ("10.0.0.0/8", "203.0.113.9", "198.51.100.1", "203.0.113.9"),
    ],
)
def test_the_client_is_the_last_one_that_is_no_proxy(tmp_path, trusted, peer, nodes, client):
    from safestart_service.access.hosts import Hosts
    from safestart_service.access.proxies import Proxies

    scope: dict[str, Any] = {
        "client": (peer, 1),
        "server": ("127.0.0.1", 80),
        "path": "/",
        "headers": [(b"x-forwarded-for", nodes.encode())],
    }
    proxies = Proxies(Settings(trusted_proxies=trusted), Hosts(""))
    assert proxies.place(scope) is None
    assert scope["client"][0] == client


def test_settings_that_are_no_path_or_network(tmp_path):
    for root in ("safestart", "//evil", "/a/../b", LONG, "/a b"):
        with pytest.raises(ValueError, match="root_path"):
            Settings(root_path=root)
    for trusted in ("*", "10.0.0.1/8", "proxy.example"):
        with pytest.raises(ValueError, match="trusted_proxies"):
            Settings(trusted_proxies=trusted)
    with pytest.raises(InvalidInput, match="root_path"):
        create_app(Settings(root_path="/jobs/x", database_url=url_of(tmp_path)))

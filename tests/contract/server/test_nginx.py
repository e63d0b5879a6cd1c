"""The service behind a real nginx with TLS, below /safestart/, by the file that docs/operations.md prints."""

from __future__ import annotations

import json
import re
from typing import Any

import httpx
import pytest

from tests.contract.api.service_client import HEAVY, POINT, assert_problem, finish, jobs_of
from tests.contract.server.nginx import NAME, NGINX, ROOT, VARIANTS, Front, fronts

OTHERS = {"execution": 405, "go-no-go": 422}
"""What a GET of a link answers that is for POST, or that wants a question."""

pytestmark = pytest.mark.skipif(NGINX is None, reason="no nginx: apt-get install nginx")


@pytest.fixture(scope="module")
def nginx(tmp_path_factory):
    """nginx in front of two services, one of them with the setting ``root_path``."""
    with fronts(tmp_path_factory.mktemp("nginx")) as found:
        yield found


@pytest.fixture(params=VARIANTS)
def front(nginx, request) -> Front:
    return nginx[request.param]


@pytest.fixture
def client(front):
    with front.client() as found:
        yield found


def links(document: Any) -> list[str]:
    """The addresses in a JSON document that are not the standard's names."""
    found = re.findall(r'"(?:href|url)":\s*"([^"]+)"', json.dumps(document))
    return [link for link in found if "opengis" not in link]


def test_links_lead_back_through_it(front, client):
    queued = client.post("/processes/benchmark/execution", json=HEAVY)
    assert queued.status_code == 201, queued.text
    assert queued.headers["location"] == f"{front.base}/jobs/{queued.json()['jobID']}"
    finish(jobs_of(front.folder))
    found = set()
    for path in (
        "/",
        "/processes/benchmark",
        f"/jobs/{queued.json()['jobID']}",
        f"/jobs/{queued.json()['jobID']}/results",
    ):
        found |= set(links(client.get(path).json()))
    assert len(found) > 12
    for link in found:
        answer = client.get(front.local(link))
        assert answer.status_code == OTHERS.get(link.rpartition("/")[2], 200), link
        assert answer.http_version == "HTTP/1.1"
    proof = client.get("/go-no-go", params={**POINT, "x_m": 5, "y_m": 40}).json()["proof_url"]
    assert proof.startswith(f"{ROOT}/go-no-go/proof?")


def test_events_come_at_once(client):
    """They come while the stream is open: a proxy that kept them back would show none until its end."""
    job = client.post("/processes/benchmark/execution", json=HEAVY).json()["jobID"]
    told: list[Any] = []
    with client.stream("GET", f"/jobs/{job}/events") as stream:
        assert stream.headers["content-type"].startswith("text/event-stream")
        for line in stream.iter_lines():
            if line.startswith("data: "):
                told.append(json.loads(line.removeprefix("data: ")).get("status"))
                if len(told) == 1:
                    assert client.delete(f"/jobs/{job}").json()["status"] == "dismissed"
    assert told == ["accepted", "dismissed"]


def test_pages_and_their_files(front, client):
    sent = client.get("/", headers={"Accept": "text/html"})
    assert (sent.status_code, sent.headers["location"]) == (303, f"{front.base}/dashboard")
    bare = client.get(front.local(front.base))
    assert (bare.status_code, httpx.URL(bare.headers["location"]).path) == (301, f"{ROOT}/")
    page = client.get("/dashboard").text
    files = re.findall(r'(?:href|src)="([^"#]+)"', page)
    assert len(files) > 6
    for path in files:
        assert path.startswith(f"{ROOT}/"), path
        assert client.get(front.local(front.base.removesuffix(ROOT) + path)).status_code == 200, path


def test_what_a_stranger_says_is_overwritten(front, client):
    """The file sets or deletes each field, so that nobody chooses the links of another's answer."""
    plain = client.get("/").json()
    lies = {
        "X-Forwarded-Prefix": "//evil.example",
        "X-Forwarded-Host": "evil.example",
        "X-Forwarded-Proto": "javascript",
        "X-Forwarded-For": "203.0.113.5",
    }
    for name, value in lies.items():
        assert client.get("/", headers={name: value}).json() == plain
    assert client.get("/jobs", headers=lies).status_code == 200, "asked from this machine, whatever it says"
    assert_problem(client.get("/", headers={"Host": "evil.example"}), 421, "Host")
    assert plain["links"][0]["href"] == f"https://{NAME}:{front.port}{ROOT}/"

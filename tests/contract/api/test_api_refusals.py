"""Bad input in every form: always a 4xx problem that names the field, and nothing is queued."""

from __future__ import annotations

import gzip
import json
from typing import Any

import pytest

from tests.contract.api.service_client import POINT, assert_problem, jobs_of, service, submit

STATE = {"x_m": 5, "y_m": 40}
LONG = 10**400


@pytest.fixture(scope="module")
def setting(tmp_path_factory):
    """A client, and its queue, which must stay empty."""
    folder = tmp_path_factory.mktemp("refusals")
    with service(folder) as client:
        yield client, jobs_of(folder)


@pytest.fixture
def client(setting):
    found, jobs = setting
    yield found
    assert sum(jobs.counts().values()) == 0, "a refused request queued a job"


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"omega_t_deg_s": "nan"}, "omega_t_deg_s"),
        ({"omega_t_deg_s": "inf"}, "omega_t_deg_s"),
        ({"omega_t_deg_s": "-1"}, "omega_t_deg_s"),
        ({"omega_t_deg_s": "3000"}, "omega_t_deg_s"),
        ({"omega_t_deg_s": ""}, "omega_t_deg_s"),
        ({"omega_t_deg_s": None}, "omega_t_deg_s"),
        ({"omega_t_deg_s": "1_0"}, "omega_t_deg_s"),
        ({"a_max_m_s2": "0"}, "a_max_m_s2"),
        ({"a_max_m_s2": "-0.1"}, "a_max_m_s2"),
        ({"a_max_m_s2": "100"}, "a_max_m_s2"),
        ({"x_m": "1e300"}, "x_m"),
        ({"x_m": "9" * 400}, "x_m"),
        ({"y_m": "forty"}, "y_m"),
        ({"z_m": "-Infinity"}, "z_m"),
        ({"z_m": "null"}, "z_m"),
        ({"mean_motion_rad_s": "1"}, "mean_motion_rad_s"),
        ({"c_x": "0"}, "c_x"),
        ({"rest": "moon"}, "rest"),
        ({"colour": "red"}, "colour"),
        ({"x_m": ["1", "2"]}, "x_m"),
    ],
)
def test_bad_queries(client, change, field):
    query: dict[str, Any] = {**POINT, **STATE, **change}
    query = {name: value for name, value in query.items() if value is not None}
    assert_problem(client.get("/go-no-go", params=query), 422, field)


def test_query_too_long(client):
    assert_problem(client.get("/go-no-go?x_m=" + "1" * 9000), 414, "query")


BAD_POINTS: list[tuple[dict[str, Any], str]] = [
    ({"omega_t_deg_s": float("nan")}, "omega_t_deg_s"),
    ({"omega_t_deg_s": float("inf")}, "omega_t_deg_s"),
    ({"omega_t_deg_s": -3}, "omega_t_deg_s"),
    ({"omega_t_deg_s": LONG}, "omega_t_deg_s"),
    ({"omega_t_deg_s": "3"}, "omega_t_deg_s"),
    ({"omega_t_deg_s": True}, "omega_t_deg_s"),
    ({"omega_t_deg_s": None}, "omega_t_deg_s"),
    ({"omega_t_deg_s": [3]}, "omega_t_deg_s"),
    ({"a_max_m_s2": 0}, "a_max_m_s2"),
    ({"a_max_m_s2": -0.1}, "a_max_m_s2"),
    ({"a_max_m_s2": 981}, "a_max_m_s2"),
    ({"mean_motion_rad_s": 0.06}, "mean_motion_rad_s"),
    ({"corridor": {"c_x": 0}}, "corridor.c_x"),
    ({"corridor": {"width": 3}}, "corridor.width"),
    ({"corridor": 7}, "corridor"),
    ({"colour": "red"}, "colour"),
]
BAD_GRIDS: list[tuple[dict[str, Any], str]] = [
    ({"grid": {"nx": 0}}, "grid.nx"),
    ({"grid": {"nx": 31.5}}, "grid.nx"),
    ({"grid": {"nx": 10**6}}, "grid.nx"),
    ({"grid": {"ny": LONG}}, "grid.ny"),
    ({"grid": {"y_max_m": 0}}, "grid.y_max_m"),
    ({"grid": {"y_max_m": 1e9}}, "grid.y_max_m"),
    ({"grid": []}, "grid"),
    ({"grid": {"nx": 1001, "ny": 1001}}, "grid"),
    ({"grid": {"y_max_m": 0.4}}, "y_max"),
]
BAD_STATES: list[tuple[dict[str, Any], str]] = [
    ({"states": []}, "states"),
    ({"states": {}}, "states"),
    ({"states": [STATE] * 100_001}, "states"),
    ({"states": [{"x_m": 5}]}, "states.0.y_m"),
    ({"states": [{**STATE, "vx_m_s": 0}]}, "states.0.vx_m_s"),
    ({"states": [{"x_m": 1e9, "y_m": 0}]}, "states.0.x_m"),
    ({"states": [STATE, {**STATE, "z_m": 1}]}, "states"),
    ({"states": [None] * 3}, "states.0"),
    ({"states": [STATE], "method": "magic"}, "method"),
]
BAD_BENCHMARKS: list[tuple[dict[str, Any], str]] = [
    ({"engines": []}, "engines"),
    ({"engines": ["warp"]}, "engines.0"),
    ({"engines": ["exact", "exact"]}, "engines"),
    ({"horizon_s": 3}, "horizon_s"),
    ({"horizon_s": 0}, "horizon_s"),
    ({"seed": -1}, "seed"),
    ({"seed": LONG}, "seed"),
    ({"grid": {"nx": 1001, "ny": 50}}, "inputs"),
]


@pytest.mark.parametrize(("change", "field"), BAD_POINTS + BAD_STATES)
def test_bad_states(client, change, field):
    body = json.dumps({**POINT, "states": [STATE], **change})
    answer = client.post("/go-no-go", content=body, headers={"Content-Type": "application/json"})
    assert_problem(answer, 422, field)


@pytest.mark.parametrize(("change", "field"), BAD_POINTS + BAD_GRIDS)
def test_bad_grids(client, change, field):
    body = json.dumps({**POINT, **change})
    answer = client.post("/certificates", content=body, headers={"Content-Type": "application/json"})
    assert_problem(answer, 422, field)


@pytest.mark.parametrize(("change", "field"), BAD_POINTS + BAD_GRIDS + BAD_BENCHMARKS)
def test_bad_executions(client, change, field):
    body = json.dumps({"inputs": {**POINT, **change}})
    answer = client.post(
        "/processes/benchmark/execution", content=body, headers={"Content-Type": "application/json"}
    )
    # A cross-field rule of the whole document is reported at the document.
    problem = assert_problem(answer, 422)
    assert field.split(".")[0] in problem["detail"] or problem["field"] == "inputs", problem


@pytest.mark.parametrize("path", ["/go-no-go", "/certificates", "/processes/benchmark/execution"])
@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"{",
        b"[1,",
        b"{'a': 1}",
        b"\xff\xfe{}",
        b'{"omega_t_deg_s": \xc3}',
        b"[" * 100_000,
        b'{"a":' * 50_000,
    ],
)
def test_bodies_that_are_not_json(client, path, body):
    answer = client.post(path, content=body, headers={"Content-Type": "application/json"})
    assert_problem(answer, 400, "body")


@pytest.mark.parametrize("path", ["/go-no-go", "/certificates", "/processes/benchmark/execution"])
@pytest.mark.parametrize("body", [b"[]", b"3", b"null", b'"text"', b"{}", b'{"inputs": null}', b"9" * 5000])
def test_bodies_of_another_shape(client, path, body):
    answer = client.post(path, content=body, headers={"Content-Type": "application/json"})
    assert answer.status_code in (400, 422)
    assert_problem(answer, answer.status_code)


@pytest.mark.parametrize(
    "kind", ["text/plain", "application/x-www-form-urlencoded", "", "json", "application/xml"]
)
def test_other_content_types(client, kind):
    headers = {"Content-Type": kind} if kind else {}
    assert_problem(client.post("/certificates", content=b"{}", headers=headers), 415, "Content-Type")


def test_many_unknown_fields(client):
    """All are counted, a few are named."""
    problem = assert_problem(
        client.post("/certificates", json=POINT | {f"k{i}": 1 for i in range(1000)}), 422, "k0"
    )
    assert problem["detail"].endswith("(and 999 more: k1, k2, k3, k4, k5)")


def test_compressed_bodies(client):
    headers = {"Content-Type": "application/json", "Content-Encoding": "gzip"}
    body = gzip.compress(json.dumps(POINT).encode())
    assert_problem(client.post("/certificates", content=body, headers=headers), 415, "Content-Encoding")
    headers["Content-Encoding"] = "identity"
    assert client.post("/certificates", json=POINT, headers=headers).status_code == 200


@pytest.mark.parametrize("path", ["/certificates", "/processes/benchmark/execution"])
def test_too_large(client, path):
    headers = {"Content-Type": "application/json"}
    assert_problem(client.post(path, content=b" " * 8_000_001, headers=headers), 413, "body")
    lying = {**headers, "Content-Length": "99999999999999999999"}
    assert_problem(client.post(path, content=b"{}", headers=lying), 413, "body")

    def chunks():
        for _ in range(9):
            yield b" " * 1_000_000

    assert_problem(client.post(path, content=chunks(), headers=headers), 413, "body")


def test_methods_and_paths(client):
    answer = client.put("/go-no-go")
    problem = assert_problem(answer, 405)
    assert answer.headers["allow"] == "GET, HEAD, OPTIONS, POST"
    assert problem["received"] == "PUT"
    assert client.post("/jobs/x").headers["allow"] == "DELETE, GET, HEAD, OPTIONS, PATCH"
    assert_problem(client.get("/nothing/here"), 404)
    assert_problem(client.get("/jobs/"), 404)


def test_security_headers_on_every_answer(client):
    for answer in (client.get("/"), client.get("/nope"), client.put("/jobs"), client.get("/go-no-go")):
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert answer.headers["x-frame-options"] == "DENY"
        assert "frame-ancestors 'none'" in answer.headers["content-security-policy"]
        assert answer.headers["x-request-id"]
    kept = client.get("/healthz", headers={"X-Request-ID": "trace-7"})
    assert kept.headers["x-request-id"] == "trace-7"
    refused = client.get("/healthz", headers={"X-Request-ID": "no spaces or <tags>"})
    assert refused.headers["x-request-id"] != "no spaces or <tags>"


@pytest.mark.parametrize(
    "host",
    ["evil.example", "evil.example:80", "localhost.evil.example", "1.2.3.4.evil", "1", "_", "xn--e1afmkfd"],
)
def test_foreign_host_headers(client, host):
    """DNS rebinding: a page of evil.example whose name points here asks with its own name in Host."""
    for path in ("/", "/healthz", "/jobs", "/nope", "/go-no-go"):
        problem = assert_problem(client.get(path, headers={"Host": host}), 421, "Host")
        assert problem["type"].endswith("misdirected-request")
    assert_problem(client.post("/processes/coverage/execution", json={}, headers={"Host": host}), 421)


@pytest.mark.parametrize(
    "host",
    [
        *(
            "",
            ":80",
            "[",
            "[]",
            "[::1",
            "[::1]x",
            "[::1]:99999",
            "[127.0.0.1]",
            "[localhost]",
            "[::1::]",
            "::1",
        ),
        *(
            "localhost:65536",
            "localhost:-1",
            "localhost:x",
            "localhost:1:2",
            "a b",
            "evil.example/x",
            "user@host",
        ),
        *("a,b", "localhost,localhost", "x" * 300),
    ],
)
def test_what_is_no_host(client, host):
    for path in ("/healthz", "/jobs"):
        problem = assert_problem(client.get(path, headers={"Host": host}), 400, "Host")
        assert problem["type"].endswith("malformed-request")


@pytest.mark.parametrize("hosts", [("evil.example", "localhost"), ("localhost", "evil.example")])
def test_two_hosts(client, hosts):
    """The check must not look at one and the links at the other."""
    assert_problem(client.get("/", headers=[("Host", host) for host in hosts]), 400, "Host")


@pytest.mark.parametrize(
    "host",
    [
        "localhost",
        "LOCALHOST:8000",
        "x.localhost",
        "127.0.0.1:8000",
        "[::1]:8000",
        "[FE80::1]:65535",
        "192.0.2.7",
    ],
)
def test_hosts_that_cannot_be_rebound(client, host):
    assert client.get("/healthz", headers={"Host": host}).status_code == 200


def test_hosts_by_setting(tmp_path):
    with service(tmp_path, allowed_hosts="gate.example") as client:
        answer = client.get("/", headers={"Host": "Gate.example:8443"})
        assert answer.json()["links"][0]["href"] == "http://Gate.example:8443/"


def test_long_idempotency_key(tmp_path):
    with service(tmp_path) as client:
        answer = client.post(
            "/processes/coverage/execution", json={"inputs": {}}, headers={"Idempotency-Key": "k" * 256}
        )
        assert_problem(answer, 422, "Idempotency-Key")
        submit(client, **{"Idempotency-Key": "k" * 255})


def test_fewer_states_by_setting(tmp_path):
    with service(tmp_path, max_states=2) as client:
        assert_problem(client.post("/go-no-go", json={**POINT, "states": [STATE] * 3}), 422, "states")
        execution = {"inputs": {**POINT, "states": [STATE] * 3}}
        assert_problem(client.post("/processes/go-no-go/execution", json=execution), 422, "states")


def test_so_many_mistakes_are_named_and_the_others_counted(client):
    """The first in full, five by their fields, and how many there are: the answer does not grow with the body."""
    asked = POINT | {f"wrong{k:02d}": 1 for k in range(50)}
    problem = assert_problem(client.post("/certificates", json=asked), 422, "wrong00")
    assert "(and 49 more: wrong01, wrong02, wrong03, wrong04, wrong05)" in problem["detail"]

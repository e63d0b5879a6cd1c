"""`safestart.Client` against a service: the same calls give the same results, refusals come as our exceptions."""

from __future__ import annotations

from dataclasses import fields

import httpx
import numpy as np
import pytest

import safestart as ss
from safestart.errors import Altered, Away, InvalidInput, JobFailed, NotFound, Unavailable
from safestart.public.wire import _refusal
from tests.contract.api.service_client import BASE, HEAVY, finish, jobs_of, service

POINT = ss.Scenario.of(3.0, 0.1, 1.0e-3)
STARTS = np.array([[5.0, 40.0], [0.0, 149.0], [90.0, 20.0], [0.0, 90.0]])


@pytest.fixture
def client(tmp_path):
    with service(tmp_path) as http, ss.Client(BASE, http=http) as client:
        yield client


def same(one, two):
    assert type(one) is type(two)
    for field in fields(one):
        a, b = getattr(one, field.name), getattr(two, field.name)
        if isinstance(a, np.ndarray):
            assert np.array_equal(a, b, equal_nan=a.dtype.kind == "f"), field.name
        elif isinstance(a, float) and np.isnan(a):
            assert np.isnan(b), field.name
        else:
            assert a == b, field.name


def test_the_same_calls_give_the_same_results(client):
    ours, theirs = ss.certify(POINT, STARTS), client.certify(POINT, STARTS)
    assert np.array_equal(ours.verdict, theirs.verdict)
    assert np.allclose(ours.margin_m, theirs.margin_m, rtol=0.0, atol=1e-9, equal_nan=True)
    space = np.column_stack([STARTS, [1.0, 0.0, 0.0, -2.0]]).reshape(2, 2, 3)
    assert np.array_equal(
        ss.certify(POINT, space, "body").verdict, client.certify(POINT, space, "body").verdict
    )
    for start in STARTS[:2]:
        same(ss.decide(POINT, start), client.decide(POINT, start))
    asked = {"question": "synchronize", "within_s": 120.0}
    same(ss.decide(POINT, (5.0, 30.0), "body", **asked), client.decide(POINT, (5.0, 30.0), "body", **asked))
    assert client.verify(client.decide(POINT, STARTS[0]).proof).verdict == "GO"
    same(ss.region(POINT, horizon_s=20.0), client.region(POINT, horizon_s=20.0))
    same(ss.fly(POINT, STARTS[0]), client.fly(POINT, STARTS[0]))
    assert "benchmark" in client.processes()


def test_a_job_is_followed_to_its_result(client, tmp_path, capsys):
    job = client.submit("benchmark", HEAVY["inputs"])
    with pytest.raises(Unavailable, match="within 0 s"):
        client.result(job, limit_s=0, progress=False)
    finish(jobs_of(tmp_path))
    result = client.result(job)
    assert "benchmark" in capsys.readouterr().err
    assert result.outputs["rows"] == [{"engine": "analytical", "area_m2": 12.5}]
    assert list(result.pictures) == ["map.png"]
    assert "data:image/png;base64," in result._repr_html_()
    assert list(result.to_dataframe("rows").engine) == ["analytical"]


def test_a_job_is_labelled(client, tmp_path):
    job = client.submit("benchmark", HEAVY["inputs"], name="first", tags=("a", "b"))
    client.label(job, note="later")
    stored = jobs_of(tmp_path).get(job)
    assert (stored.name, stored.tags, stored.note) == ("first", ["a", "b"], "later")
    with pytest.raises(InvalidInput, match="tags"):
        client.submit("benchmark", HEAVY["inputs"], tags=["a,b"])
    with pytest.raises(InvalidInput, match="tags"):
        client.label(job, tags="ab")
    with pytest.raises(NotFound):
        client.label("nothing", name="x")


def test_a_job_that_ends_badly_says_why(client):
    job = client.submit("benchmark", HEAVY["inputs"])
    client._wire.answered("DELETE", f"/jobs/{job}", None, None, again=False)
    with pytest.raises(JobFailed, match="dismissed"):
        client.result(job, progress=False)


def test_refusals_are_our_exceptions(client):
    with pytest.raises(InvalidInput, match="omega_t_deg_s") as caught:
        client.submit("benchmark", {"a_max_m_s2": 0.1})
    assert caught.value.field == "inputs.omega_t_deg_s"
    with pytest.raises(NotFound):
        client.submit("nothing")
    with pytest.raises(NotFound):
        client.result("nothing", progress=False)
    with pytest.raises(InvalidInput, match="10000 m"):
        client.certify(POINT, [[2e4, 1.0]])
    request = httpx.Request("GET", BASE)
    assert isinstance(_refusal(httpx.Response(502, request=request, text="<html>")), ss.SafestartError)
    assert isinstance(_refusal(httpx.Response(503, request=request, json=[1])), Unavailable)


def test_altered_files_and_silent_services_are_noticed(monkeypatch):
    monkeypatch.setattr("safestart.public.wire._PAUSE_S", 0.0)
    entry = {"name": "map.png", "media_type": "image/png", "sha256": "0" * 64}
    answers = {
        "/jobs/a": {"status": "successful", "processID": "benchmark"},
        "/jobs/a/results": {"artifacts": [entry]},
    }

    def answer(request: httpx.Request) -> httpx.Response:
        found = answers.get(request.url.path)
        return httpx.Response(200, json=found) if found else httpx.Response(200, content=b"other")

    with ss.Client(BASE, http=httpx.Client(transport=httpx.MockTransport(answer))) as client:
        with pytest.raises(Altered, match="SHA-256"):
            client.result("a", progress=False)
        with pytest.raises(Away, match="JSON"):
            client.processes()

    tries = []

    def silent(request: httpx.Request) -> httpx.Response:
        tries.append(request.method)
        raise httpx.ConnectError("refused")

    with ss.Client(BASE, http=httpx.Client(transport=httpx.MockTransport(silent))) as client:
        with pytest.raises(Away, match="answers"):
            client.processes()
        with pytest.raises(Away, match="answers"):
            client.decide(POINT, STARTS[0])
    assert tries == ["GET"] * 5 + ["POST"]


def test_a_key_goes_with_every_request():
    seen = []

    def answer(request: httpx.Request) -> httpx.Response:
        seen.append(request.headers.get("authorization"))
        return httpx.Response(200, json={"processes": []})

    with ss.Client(BASE, "secret", http=httpx.Client(transport=httpx.MockTransport(answer))) as client:
        assert client.processes() == {}
    assert seen == ["Bearer secret"]

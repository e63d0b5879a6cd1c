"""What is going to be removed says so, in its answers and in the description."""

from __future__ import annotations

from datetime import UTC, datetime

import pytest

from safestart_service.documents import deprecation
from safestart_service.documents.deprecation import Notice
from tests.contract.api.service_client import service

SINCE, UNTIL = datetime(2027, 1, 1, tzinfo=UTC), datetime(2027, 7, 1, tzinfo=UTC)
SAID = {
    "deprecation": "@1798761600",
    "sunset": "Thu, 01 Jul 2027 00:00:00 GMT",
    "link": '<https://docs.example/api>; rel="deprecation"; type="text/html"',
}


def said(answer):
    return {name: answer.headers[name] for name in SAID if name in answer.headers}


def test_a_deprecated_call_and_parameter(tmp_path, monkeypatch):
    whole, part = (Notice(SINCE, UNTIL, "https://docs.example/api", name) for name in (None, "limit"))
    notices = {("GET", "/jobs/{jobID}"): whole, ("GET", "/jobs"): part}
    monkeypatch.setattr(deprecation, "NOTICES", notices)
    with service(tmp_path) as client:
        assert said(client.get("/jobs/none")) == SAID, "refusals say so, too"
        assert said(client.head("/jobs/none")) == SAID
        assert said(client.delete("/jobs/none")) == {}
        assert said(client.get("/jobs?limit=1")) == SAID
        assert said(client.get("/jobs?status=failed")) == {}
        assert said(client.get("/nothing")) == {}
        paths = client.get("/openapi.json").json()["paths"]
    marked = [
        (method, path)
        for path, methods in paths.items()
        for method, operation in methods.items()
        if operation.get("deprecated")
    ]
    assert marked == [("get", "/jobs/{jobID}")]
    limits = [item for item in paths["/jobs"]["get"]["parameters"] if item.get("deprecated")]
    assert [item["name"] for item in limits] == ["limit"]


def test_a_notice_about_nothing_is_found_out(tmp_path, monkeypatch):
    notice = Notice(SINCE, UNTIL, "https://docs.example/api")
    monkeypatch.setattr(deprecation, "NOTICES", {("GET", "/gone"): notice})
    with service(tmp_path) as client, pytest.raises(KeyError, match="/gone"):
        client.app.openapi()
    with pytest.raises(ValueError, match="until: required after"):
        Notice(UNTIL, SINCE, "https://docs.example/api")


def test_the_method_that_is_called_paper_now(client):
    start = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "x_m": 5, "y_m": 40}
    notice = deprecation.RENAMED_METHOD
    for path in ("/go-no-go", "/go-no-go/proof"):
        assert said(client.get(path, params=start)) == {}
        assert said(client.get(path, params=start | {"method": "paper"})) == {}
        old = said(client.get(path, params=start | {"method": "closed_form"}))
        assert old["deprecation"] == f"@{int(notice.since.timestamp())}"
        assert old["link"] == '</docs>; rel="deprecation"; type="text/html"'
        assert said(client.get(f"{path}?method=closed%5Fform")) == old, "escaped, and refused"
    many = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "states": [{"x_m": 5, "y_m": 40}]}
    assert said(client.post("/go-no-go", json=many)) == {}
    assert said(client.post("/go-no-go", json=many | {"method": "closed_form"})) == old
    assert said(client.get("/conformance")) == {}

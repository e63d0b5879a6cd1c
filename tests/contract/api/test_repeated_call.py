"""A helper process that dies with its work done: the work is done again by another one, and makes no second job."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from safestart_service.computing.helpers.process import Helper, NotBegun
from safestart_service.computing.limits import SMALL_BYTES
from tests.contract.api.service_client import HEAVY, jobs_of, service

LARGE = json.dumps(HEAVY) + " " * SMALL_BYTES


@pytest.mark.parametrize("key", [{}, {"Idempotency-Key": "k"}])
def test_a_submission_whose_helper_dies_is_one_job(
    key: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ask, died = Helper.ask, []

    def dying(helper: Helper, function: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[bool, Any]:
        found = ask(helper, function, arguments)
        if not died:
            died.append(helper)
            raise NotBegun
        return found

    monkeypatch.setattr(Helper, "ask", dying)
    with service(tmp_path, max_queued=1) as client:
        headers = {"Content-Type": "application/json", **key}
        answer = client.post("/processes/benchmark/execution", content=LARGE, headers=headers)
        assert answer.status_code == 201, answer.text
        assert died
        assert "Idempotency-Replayed" not in answer.headers, "for its client it is the first"
        assert "certificate" in answer.json(), "the instant answer comes, too"
        assert [job.id for job in jobs_of(tmp_path).list().jobs] == [answer.json()["jobID"]]
        events = jobs_of(tmp_path).events(answer.json()["jobID"])
        assert len(events) == 1
        if key:
            again = client.post("/processes/benchmark/execution", content=LARGE, headers=headers)
            assert again.headers["Idempotency-Replayed"] == "true"
            assert again.json()["jobID"] == answer.json()["jobID"]

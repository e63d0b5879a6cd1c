"""The same answers over HTTP, for the digests: ``python -m tests.acceptance.digested.service KEEP NAME ...``.

``safestart up`` runs the questions as jobs, and gives each result in every form that it offers.
"""

from __future__ import annotations

import json
import os
import sys
import time
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from tests.acceptance.digested.calls import AT_ONCE
from tests.acceptance.digested.questions import asked
from tests.acceptance.digested.runs import Answer, told
from tests.acceptance.running import Running

NO_SUCH_TABLE = "no such table"
_OF_THE_JOB = ("jobID", "artifacts")


def answer(up: Running, name: str) -> Answer:
    """The files that answer a question, ``service/PROCESS/WHAT`` or one of those that are answered at once."""
    if name in AT_ONCE:
        return at_once(up, AT_ONCE[name])
    process_id, (*_, inputs) = asked(name.removeprefix("service/"))
    return job(up, process_id, inputs)


def at_once(up: Running, calls: tuple[tuple[str, str, dict[str, Any]], ...]) -> Answer:
    """What the service answers to calls without a queue."""
    files = {}
    for place, (method, path, words) in enumerate(calls):
        given = {"params": words} if method == "GET" else {"json": words}
        response = up.client.request(method, path, **given)
        document = {"status": response.status_code, "body": _local(up, response.json())}
        files[f"answer-{place + 1}.json"] = _text(document)
    return files


def job(up: Running, process_id: str, inputs: dict[str, Any]) -> Answer:
    """Record, results of the standard, tables, arrays and artifacts of a job."""
    submitted = up.client.post(
        f"/processes/{process_id}/execution", json={"inputs": inputs}, headers={"Prefer": "respond-async"}
    )
    assert submitted.status_code == 201, submitted.text
    body = submitted.json()
    results = _ended(up, f"/jobs/{body['jobID']}")
    record = _get(up, results).json()
    kept = {key: value for key, value in record.items() if key not in _OF_THE_JOB}
    files = {
        "instant.json": _text({key: body.get(key) for key in ("instant", "certificate")}),
        "record.json": _text(kept),
        "results.json": _text(_local(up, _get(up, results, format="ogc").json(), body["jobID"])),
        "results.npz": _get(up, results, format="npz").content,
    }
    for table in tables(up, results):
        for form in ("csv", "parquet"):
            files[f"{table}.{form}"] = _get(up, results, format=form, table=table).content
    for file in record["artifacts"]:
        files[f"artifacts/{file['name']}"] = up.client.get(file["href"]).content
    return files


def _ended(up: Running, path: str) -> str:
    """Wait as long as it takes, and give the path of the results."""
    while (status := _get(up, path, wait="20").json())["status"] in ("accepted", "running"):
        pass
    assert status["status"] == "successful", status
    return f"{path}/results"


def tables(up: Running, results: str) -> list[str]:
    """Names of the tables of a result; the service lists them when asked for an unknown one."""
    refusal = up.client.get(results, params={"format": "csv", "table": NO_SUCH_TABLE})
    if refusal.status_code == 406:
        return []
    assert refusal.status_code == 422, refusal.text
    required: str = refusal.json()["required"]
    return required.removeprefix("one of ").split(", ")


def _get(up: Running, path: str, **parameters: str) -> Any:
    response = up.client.get(path, params=parameters)
    assert response.is_success, response.text
    return response


def _local(up: Running, document: Any, job_id: str = "JOB") -> Any:
    """The document without the address and the id of this run."""
    text = json.dumps(document).replace(up.url, "").replace(job_id, "JOB")
    return json.loads(text)


def _text(document: Any) -> bytes:
    return json.dumps(document, allow_nan=False).encode()


def main(kept: str, names: list[str]) -> None:
    """Answer each question; two lines for each: the answer, and seconds that it took."""
    stdout = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # whatever else is printed is no line of ours
    with TemporaryDirectory() as folder:
        up = Running(Path(folder))
        try:
            for name in names:
                start = time.monotonic()
                found = told(name, kept, partial(answer, up, name))
                stdout.write(f"{json.dumps(found)}\n{time.monotonic() - start}\n")
                stdout.flush()
        finally:
            up.stop()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])

"""Partial results of a sharded job over the API: they grow, stay after a failure, and make way for the result."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

from safestart.processes.registry import process
from safestart.runtime.progress import Context
from tests.contract.api.service_client import assert_problem, finish, jobs_of, service, submit

INPUTS: dict[str, Any] = {
    "controllers": ["filter"],
    "certificates": ["paper"],
    "cases_per_cell": 2000,
    "omega_t_deg_s": [1, 4],
    "a_max_m_s2": [0.1],
    "records": 0,
}


def test_partial_results_grow_with_the_shards(tmp_path: Path) -> None:
    spec = process("sweep")
    assert spec.sharding is not None
    inputs = spec.parse(INPUTS)
    parts = spec.sharding.parts(inputs)
    assert len(parts) == 2
    done = [spec.sharding.run_part(part, Context()) for part in parts]
    with service(tmp_path) as client:
        jobs = jobs_of(tmp_path)
        answer = client.post("/processes/sweep/execution", json={"inputs": INPUTS})
        assert answer.status_code == 201, answer.text
        url = f"/jobs/{answer.json()['jobID']}/partial"
        body = client.get(url).json()
        assert (body["status"], body["shards"], body["outputs"]) == (
            "accepted",
            {"done": 0, "total": 2},
            None,
        )
        claim = jobs.claim("tester", 60.0)
        assert claim is not None
        for number, part in enumerate(done):
            jobs.save_shards(claim, [(number, f"content {number}", part.document, part.data)])
            body = client.get(url).json()
            assert body["shards"] == {"done": number + 1, "total": 2}
            assert body["outputs"]["cases"] == 8000 * (number + 1)
            spec.outputs.model_validate(body["outputs"])
        cell = body["outputs"]["confusion"]["paper"]["filter"]
        assert sum(cell[name] for name in ("tp", "fp", "fn", "tn")) == 16000
        jobs.fail(claim, {"detail": "the machine burnt down"})
        body = client.get(url).json()
        assert (body["status"], body["shards"]["done"]) == ("failed", 2)


def test_a_process_without_shards_has_no_partial_results(tmp_path: Path) -> None:
    with service(tmp_path) as client:
        job = submit(client)
        problem = assert_problem(client.get(f"/jobs/{job}/partial"), 404, "jobID")
        assert "not cut into shards" in problem["detail"]
        finish(jobs_of(tmp_path))
        assert client.get("/jobs/no-such-job/partial").status_code == 404


def test_the_service_sums_shards_without_an_engine() -> None:
    code = (
        "import sys; from safestart.processes.registry import process; s = process('sweep');"
        "i = s.parse({}); s.sharding.parts(i); s.sharding.so_far(i, []);"
        "t = process('trade-study'); j = t.parse({}); t.sharding.parts(j); t.sharding.so_far(j, []);"
        "print(sorted({'jax', 'numba', 'scipy', 'matplotlib', 'pyarrow', 'clarabel'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"

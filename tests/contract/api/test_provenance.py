"""OGC API - Processes Part 4, class Provenance: inputs and PROV-JSON of a job."""

from __future__ import annotations

from safestart.processes.registry import process
from tests.contract.api.service_client import (
    BASE,
    HEAVY,
    assert_problem,
    digest,
    finish,
    jobs_of,
    service,
    submit,
)

RELATIONS = ("used", "wasGeneratedBy", "wasAssociatedWith", "wasDerivedFrom", "actedOnBehalfOf")


def names(document):
    """Everything that relations name, and everything that is declared."""
    declared = {*document["entity"], *document["activity"], *document.get("agent", {})}
    named = {
        value
        for relation in RELATIONS
        for record in document.get(relation, {}).values()
        for value in record.values()
    }
    return named, declared


def test_before_and_after_the_result(tmp_path):
    with service(tmp_path) as client:
        job = submit(client)
        before = client.get(f"/jobs/{job}/prov").json()
        finish(jobs_of(tmp_path))
        after, record = client.get(f"/jobs/{job}/prov").json(), client.get(f"/jobs/{job}/results").json()
        for document in (before, after):
            named, declared = names(document)
            assert named <= declared
            prefixes = {name.partition(":")[0] for name in declared}
            assert prefixes <= set(document["prefix"])
        assert "wasGeneratedBy" not in before
        assert before["activity"][f"jobs:{job}"] == {"safestart:status": "accepted", "safestart:attempts": 0}
        assert (
            after["activity"][f"jobs:{job}"]["prov:endTime"]
            >= after["activity"][f"jobs:{job}"]["prov:startTime"]
        )
        assert after["entity"]["job:results"]["safestart:sha256"] == record["sha256"]
        files = [name for name in after["entity"] if name.startswith("job:artifacts/")]
        assert len(files) == len(record["artifacts"]) == 2
        for name in files:
            data = client.get(after["prefix"]["job"].removeprefix(BASE) + name.removeprefix("job:")).content
            assert after["entity"][name]["safestart:sha256"] == digest(data)


def test_inputs(tmp_path):
    with service(tmp_path) as client:
        job = submit(client)
        found = client.get(f"/jobs/{job}/inputs")
        assert found.json()["inputs"] == client.get(f"/jobs/{job}").json()["inputs"]
        assert found.json()["inputs"]["engines"] == HEAVY["inputs"]["engines"]
        assert set(found.json()["outputs"]) == set(process("benchmark").outputs.model_fields)
        again = client.get(f"/jobs/{job}/inputs", headers={"If-None-Match": found.headers["etag"]})
        assert again.status_code == 304
        for path in ("/jobs/none/inputs", "/jobs/none/prov"):
            assert_problem(client.get(path), 404)

"""RO-Crates of jobs: read by the library that others read them with, and by the rules of the specification."""

from __future__ import annotations

import io
import json
import zipfile
from hashlib import sha256
from pathlib import Path

import pytest
from rocrate.rocrate import ROCrate

from safestart.records.artifact import Artifact
from safestart.records.bundle import Bundle
from safestart.records.crate import METADATA, PROFILE, pack_crate
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.transfer import Transfer
from tests.contract.records.finished import done
from tests.contract.store.store_backends import fresh_url


@pytest.fixture
def database(tmp_path: Path) -> Database:
    found = Database(fresh_url("sqlite", tmp_path))
    found.migrate()
    return found


@pytest.fixture
def bundle(database: Database, execution) -> Bundle:
    return Transfer(database).read(done(database, execution))


def unpacked(data: bytes, folder: Path) -> Path:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        archive.extractall(folder)
    return folder


def test_another_library_reads_it(bundle: Bundle, tmp_path: Path) -> None:
    folder = unpacked(pack_crate(bundle, "https://creativecommons.org/licenses/by/4.0/"), tmp_path / "crate")
    crate = ROCrate(folder)
    root = crate.root_dataset
    assert root["identifier"] == bundle.job["id"]
    assert root["conformsTo"].id == PROFILE
    assert root["license"].id == "https://creativecommons.org/licenses/by/4.0/"
    action = root["mentions"]
    assert action.type == "CreateAction"
    assert action["instrument"]["name"] == "safestart"
    assert [one.id for one in action["object"]] == ["inputs.json"]
    assert json.loads((folder / "inputs.json").read_text()) == bundle.job["inputs"]
    made = {one.id for one in action["result"]}
    assert made == {"result.json", *(f"artifacts/{one.name}" for one in bundle.artifacts)}
    assert {one.id for one in root["hasPart"]} == made | {"inputs.json"}
    for part in root["hasPart"]:
        data = (folder / part.id).read_bytes()
        assert part["sha256"] == sha256(data).hexdigest()
        assert part["contentSize"] == str(len(data))


def test_every_entity_is_described_once(bundle: Bundle, tmp_path: Path) -> None:
    """RO-Crate 1.1: the graph is flat, identifiers are unique, what is referred to within the crate is there."""
    document = json.loads((unpacked(pack_crate(bundle), tmp_path / "crate") / METADATA).read_text())
    graph = {one["@id"]: one for one in document["@graph"]}
    assert len(graph) == len(document["@graph"])
    assert all("@type" in one for one in graph.values())
    for one in graph.values():
        for value in one.values():
            for item in value if isinstance(value, list) else [value]:
                if isinstance(item, dict):
                    assert set(item) == {"@id"}, "entities are not nested"
                    if not item["@id"].startswith("http"):
                        assert item["@id"] in graph
    root = graph["./"]
    assert {"name", "description", "datePublished", "license", "hasPart"} <= set(root)
    assert root["license"].startswith("No licence is stated")


def test_the_same_job_gives_the_same_bytes(bundle: Bundle) -> None:
    assert pack_crate(bundle) == pack_crate(bundle)


def test_names_of_files_are_addresses(bundle: Bundle, tmp_path: Path) -> None:
    odd = Bundle(bundle.job, bundle.result, bundle.events, (Artifact("a b#1?ü.txt", "text/plain", b"x"),))
    folder = unpacked(pack_crate(odd), tmp_path / "crate")
    document = json.loads((folder / METADATA).read_text())
    (one,) = (part for part in document["@graph"] if part.get("encodingFormat") == "text/plain")
    assert one["@id"] == "artifacts/a%20b%231%3F%C3%BC.txt"
    assert (folder / "artifacts" / one["name"]).read_bytes() == b"x"


def test_a_failed_job_says_why(database: Database, tmp_path: Path) -> None:
    jobs = JobRepository(database)
    job = jobs.submit("benchmark", {"x": 1}, timeout_s=60.0)
    claim = jobs.claim("worker", 30.0)
    assert claim is not None
    jobs.fail(claim, {"title": "Failed", "detail": "out of memory", "status": 500})
    folder = unpacked(pack_crate(Transfer(database).read(job.id)), tmp_path / "crate")
    action = ROCrate(folder).root_dataset["mentions"]
    assert action["actionStatus"] == "http://schema.org/FailedActionStatus" or action[
        "actionStatus"
    ].id.endswith("FailedActionStatus")
    assert action["error"] == "out of memory"
    assert action["result"] == []

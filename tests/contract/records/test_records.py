"""Bundles, and the commands of the record, on every backend."""

from __future__ import annotations

import io
import json
import zipfile
from base64 import b64encode
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from safestart.cli import build
from safestart.cli.records import age
from safestart.errors import Altered, Conflict, InvalidInput, SafestartError
from safestart.records.artifact import Artifact
from safestart.records.bundle import pack, unpack
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.jobs.results import ResultRepository
from safestart.store.models import ArtifactRow, ResultRow
from safestart.store.transfer import Transfer
from tests.contract.api.service_client import SMALL
from tests.contract.records.finished import done


def rewritten(data: bytes, name: str, content: bytes | None) -> bytes:
    """The archive with one member replaced, added or (None) removed."""
    target = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(target, "w") as new:
        for item in old.namelist():
            if item != name:
                new.writestr(item, old.read(item))
        if content is not None:
            new.writestr(name, content)
    return target.getvalue()


# --- bundles ---


def test_a_job_goes_through_a_bundle_into_another_database(
    database: Database, execution: Any, tmp_path: Path
) -> None:
    job = done(database, execution)
    data, seal = pack(Transfer(database).read(job))
    assert pack(Transfer(database).read(job)) == (data, seal), "the same job gives the same bytes"
    assert b"somebody" not in zipfile.ZipFile(io.BytesIO(data)).read("job.json")
    other = Database(f"sqlite:///{tmp_path / 'other.sqlite3'}")
    other.migrate()
    assert Transfer(other).add(unpack(data, seal)) is True
    assert Transfer(other).add(unpack(data, seal)) is False, "a second time changes nothing"
    before, after = ResultRepository(database), ResultRepository(other)
    assert after.result(job).document == before.result(job).document
    assert after.result(job).sha256 == before.result(job).sha256
    assert after.artifacts(job) == before.artifacts(job)
    for info in before.artifacts(job):
        assert after.artifact(job, info.name).data == before.artifact(job, info.name).data
    there, here = JobRepository(other).get(job), JobRepository(database).get(job)
    assert (there.status, there.inputs, there.finished_at) == (here.status, here.inputs, here.finished_at)
    old, new = JobRepository(database).events(job), JobRepository(other).events(job)
    assert [(event.kind, event.data, event.at) for event in new] == [(e.kind, e.data, e.at) for e in old]
    assert pack(Transfer(other).read(job)) == (data, seal)
    other.close()


def test_a_bundle_opens_without_a_server(database: Database, execution: Any) -> None:
    data, _ = pack(Transfer(database).read(done(database, execution)))
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        page = archive.read("index.html").decode()
        names = set(archive.namelist())
    assert "<script" not in page
    assert "http" not in page.replace("http-equiv", "")
    style = page.partition("<style>")[2].partition("</style>")[0]
    allowed = b64encode(sha256(style.encode()).digest()).decode()
    assert f"default-src 'none'; img-src 'self' file:; style-src 'sha256-{allowed}'" in page
    assert page.index("<th>engine</th>") < page.index("<th>area_m2</th>"), "what a row is about comes first"
    assert page.index("<img") < page.index("<h2>Outputs</h2>"), "what is seen at a glance comes first"
    for item in execution.artifacts:
        assert f'href="artifacts/{item.name}"' in page
        assert f"artifacts/{item.name}" in names
    assert "analytical" in page


def test_the_page_of_a_bundle_runs_nothing_that_a_job_says(database: Database, execution: Any) -> None:
    bundle = Transfer(database).read(done(database, execution))
    evil = "<script>alert(1)</script>"
    bundle.job["message"] = evil
    bundle.job["inputs"] = {evil: [{evil: evil}]}
    page = zipfile.ZipFile(io.BytesIO(pack(bundle)[0])).read("index.html").decode()
    assert "<script" not in page
    assert "&lt;script&gt;" in page


def test_every_altered_bundle_is_refused_with_what_differs(database: Database, execution: Any) -> None:
    data, seal = pack(Transfer(database).read(done(database, execution)))
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    assert len(parts) >= 6
    for name, content in parts.items():
        if name == "manifest.json":
            continue
        with pytest.raises(
            InvalidInput, match=rf"{name} was altered: .*; the manifest says SHA-256 \w+, \d+ bytes"
        ):
            unpack(rewritten(data, name, content[:-1] + bytes([content[-1] ^ 1])))
        with pytest.raises(InvalidInput, match=f"{name} is missing"):
            unpack(rewritten(data, name, None))
    with pytest.raises(InvalidInput, match=r"extra\.txt is not in the manifest"):
        unpack(rewritten(data, "extra.txt", b"x"))
    with pytest.raises(InvalidInput, match=r"no manifest\.json"):
        unpack(rewritten(data, "manifest.json", None))
    for wrong in (data[: len(data) // 2], b"", b"PK rubbish"):
        with pytest.raises(InvalidInput, match="cannot be unpacked"):
            unpack(wrong)
    with pytest.raises(InvalidInput, match="its seal is"):
        unpack(data, "0" * 64)
    assert unpack(data, seal.upper()).job["id"]


def test_a_bundle_that_was_altered_and_sealed_again_is_told_by_its_seal_or_its_contradictions(
    database: Database, execution: Any
) -> None:
    bundle = Transfer(database).read(done(database, execution))
    _, seal = pack(bundle)
    assert bundle.result is not None
    name = bundle.artifacts[0].name
    forged = [
        Artifact(a.name, a.media_type, b"forged" if a.name == name else a.data) for a in bundle.artifacts
    ]
    data, other = pack(type(bundle)(bundle.job, bundle.result, bundle.events, tuple(forged)))
    assert other != seal
    with pytest.raises(InvalidInput, match=f"artifact {name} is not the one"):
        unpack(data)
    result = json.loads(json.dumps(bundle.result))
    result["outputs"]["rows"][0]["area_m2"] = 1.0
    data, other = pack(type(bundle)(bundle.job, result, bundle.events, bundle.artifacts))
    with pytest.raises(InvalidInput, match="its seal is"):
        unpack(data, seal)
    with pytest.raises(Conflict, match="has another result"):
        Transfer(database).add(unpack(data, other))


def test_a_job_that_has_not_ended_is_not_exported(database: Database) -> None:
    job = JobRepository(database).submit("benchmark", SMALL, timeout_s=60.0)
    with pytest.raises(Conflict, match="is accepted; required a job that has ended"):
        Transfer(database).read(job.id)
    JobRepository(database).dismiss(job.id)
    bundle = unpack(pack(Transfer(database).read(job.id))[0])
    assert (bundle.job["status"], bundle.result) == ("dismissed", None)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("status", "running"),
        ("status", "x"),
        ("id", ""),
        ("inputs", []),
        ("created_at", "2026-01-01"),
        ("id", None),
    ],
)
def test_a_bundle_with_impossible_facts_is_refused(
    database: Database, execution: Any, name: str, value: Any
) -> None:
    bundle = Transfer(database).read(done(database, execution))
    bundle.job[name] = value
    with pytest.raises(InvalidInput, match="bundle"):
        Transfer(database).add(bundle)


def test_what_was_altered_in_the_database_is_not_passed_on(database: Database, execution: Any) -> None:
    job = done(database, execution)
    with database.session(write=True) as session:
        row = session.get_one(ResultRow, job)
        row.document = row.document | {"outputs": row.document["outputs"] | {"corridor_cells": 1}}
    for read in (Transfer(database).read, ResultRepository(database).result):
        with pytest.raises(Altered, match="the result does not have the SHA-256 on record"):
            read(job)
    name = execution.artifacts[0].name
    other = done(database, execution)
    with database.session(write=True) as session:
        session.get_one(ArtifactRow, (other, name)).data = b"forged"
    for read in (Transfer(database).read, lambda job: ResultRepository(database).artifact(job, name)):
        with pytest.raises(Altered, match=f"artifact {name} does not have"):
            read(other)


@pytest.mark.parametrize(("text", "seconds"), [("30d", 2592000), ("1.5h", 5400), ("90min", 5400), ("0s", 0)])
def test_ages(text: str, seconds: float) -> None:
    assert age(text) == seconds


@pytest.mark.parametrize(
    "text", ["", "d", "-1d", "30", "1e9d", "1 year", "٣d", " 1d", "1d ", "1d\n", "1 d", "1_0d", "+1d"]
)
def test_ages_that_are_none(text: str) -> None:
    with pytest.raises(InvalidInput, match="--older-than"):
        age(text)


def test_a_job_is_labelled_by_command(execution: Any, tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'labels.sqlite3'}"
    database = Database(url)
    database.migrate()
    job, runner = done(database, execution), CliRunner()

    def label(*options: str) -> dict[str, Any]:
        answer = runner.invoke(build(), ["label", job, *options, "--json", "--database-url", url])
        assert answer.exit_code == 0, answer.output
        found: dict[str, Any] = json.loads(answer.stdout)
        return found

    label("--name", "first", "--tag", "a", "--tag", "b", "--note", "why")
    assert label() == {"job": job, "name": "first", "tags": ["a", "b"], "note": "why"}
    assert label("--no-tags", "--name", "")["tags"] == []
    stored = JobRepository(database).get(job)
    assert (stored.name, stored.tags, stored.note) == ("", [], "why")
    for wrong in (["--tag", "a,b"], ["--no-tags", "--tag", "a"], ["--name", "x" * 101]):
        answer = runner.invoke(build(), ["label", job, *wrong, "--database-url", url])
        assert isinstance(answer.exception, SafestartError), wrong
    database.close()


def test_the_commands(execution: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    url = f"sqlite:///{tmp_path / 'store.sqlite3'}"
    database = Database(url)
    database.migrate()
    job = done(database, execution)
    database.close()

    def run(*arguments: str, code: int = 0) -> str:
        ended = CliRunner().invoke(build(), arguments)
        if isinstance(ended.exception, SafestartError):
            assert code == 2
            return ended.exception.detail
        assert ended.exit_code == code, ended.output
        return ended.output

    said = run("export", job, "--output", "b.zip", "--database-url", url)
    seal = said.split("seal ")[1].split()[0]
    other = f"sqlite:///{tmp_path / 'other.sqlite3'}"
    assert "imported" in run("import", "b.zip", "--seal", seal, "--database-url", other)
    assert "its seal is" in run("import", "b.zip", "--seal", "00", "--database-url", other, code=2)
    assert '"verdict": "identical"' in run("replay", "b.zip", "--json")
    assert "1 jobs" in run("backup", "c.sqlite3", "--database-url", url)
    nowhere = f"sqlite:///{tmp_path / 'mistyped.sqlite3'}"
    for command in (("backup", "d.sqlite3"), ("purge", "--older-than", "0s"), ("export", job)):
        said = run(*command, "--database-url", nowhere, code=2)
        assert "required an existing database" in said, command
    assert not list(tmp_path.glob("mistyped*"))
    assert "1 jobs would be deleted" in run("purge", "--older-than", "0s", "--dry-run", "--database-url", url)

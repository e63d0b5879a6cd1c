"""Bundles that somebody sealed anew around parts that no job has: refused in words, on every backend."""

from __future__ import annotations

import io
import json
import zipfile
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from safestart.cli import build
from safestart.errors import InvalidInput
from safestart.records.artifact import Artifact
from safestart.records.bundle import Bundle, pack, unpack
from safestart.records.comparable import digest
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.transfer import Transfer

TIME = "2026-01-01T00:00:00+00:00"
JOB: dict[str, Any] = {
    "id": "00000000-0000-4000-8000-000000000000",
    "process_id": "coverage",
    "status": "successful",
    "inputs": {"a": 1},
    "instant": None,
    "attempts": 1,
    "timeout_s": 60.0,
    "priority": 0,
    "message": "done",
    "problem": None,
    "versions": None,
    "created_at": TIME,
    "started_at": TIME,
    "finished_at": TIME,
    "updated_at": TIME,
}
PICTURE = Artifact("map.png", "image/png", b"picture")
RESULT: dict[str, Any] = {
    "schema_version": 1,
    "process": {"id": "coverage", "version": "1.0.0"},
    "inputs": {"a": 1},
    "outputs": {"b": 2.5},
    "provenance": {"artifacts": {PICTURE.name: PICTURE.sha256}},
}
EVENT = {"at": TIME, "kind": "status", "data": {"status": "successful"}}
NAN, HUGE, HALF, NUL = float("nan"), 10**30, "\ud800", "a\0b"


def sealed(compression: int = zipfile.ZIP_DEFLATED, **changed: Any) -> bytes:
    """A bundle of these parts whose manifest fits them."""
    parts = {
        "job": JOB,
        "result": RESULT,
        "events": [EVENT],
        "name": PICTURE.name,
        "type": PICTURE.media_type,
    }
    parts |= changed
    files = {f"{part}.json": json.dumps(parts[part]).encode() for part in ("job", "result", "events")}
    files[f"artifacts/{parts['name']}"] = PICTURE.data
    try:
        hashed: Any = digest(parts["result"])
    except ValueError:
        hashed = None
    manifest = {
        "format": "safestart-bundle",
        "version": 1,
        "result_sha256": hashed,
        "job": parts["job"]["id"] if isinstance(parts["job"], dict) else None,
        "files": {
            name: {"sha256": sha256(data).hexdigest(), "size": len(data)} for name, data in files.items()
        },
        "media_types": {parts["name"]: parts["type"]},
    }
    for key, value in parts.get("manifest", {}).items():
        manifest[key] = manifest[key] | value if key in manifest else value
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", compression) as archive:
        for name, data in {**files, "manifest.json": json.dumps(manifest).encode()}.items():
            archive.writestr(name, data)
    return target.getvalue()


def test_the_parts_alone_are_a_bundle(database: Database) -> None:
    assert Transfer(database).add(unpack(sealed()))
    again = Transfer(database).read(JOB["id"])
    assert again == Bundle(JOB, RESULT, [EVENT], (PICTURE,))
    assert unpack(pack(again)[0]) == again


@pytest.mark.parametrize(
    ("part", "value"),
    [
        *(("job", JOB | {"attempts": wrong}) for wrong in (HUGE, "x", None, -1, 1.5)),
        *(("job", JOB | {"message": wrong}) for wrong in (NUL, HALF, 3, [1])),
        *(("job", JOB | {"inputs": {"a": wrong}}) for wrong in (NAN, HALF, HUGE)),
        *(("job", JOB | {"id": wrong}) for wrong in ("a/b", NUL, "x" * 37)),
        *(("job", JOB | {"priority": wrong}) for wrong in (HUGE, "high")),
        ("job", JOB | {"timeout_s": "long"}),
        ("job", {name: JOB[name] for name in JOB if name != "problem"}),
        ("job", [1]),
        *(("result", wrong) for wrong in (None, 3, [1], "x", {}, RESULT | {"outputs": [1]})),
        *(("result", RESULT | {"provenance": wrong}) for wrong in (None, 3, [1])),
        *(
            ("result", RESULT | {"provenance": RESULT["provenance"] | wrong})
            for wrong in (
                {"packages": 5},
                {"packages": {"numpy": 2}},
                {"packages": None},
                {"source_sha256": ["a"]},
                {"python": 3},
                {"machine": "x"},
                {"notes": "<script>"},
            )
        ),
        *(("result", RESULT | {"outputs": {"b": wrong}}) for wrong in (NAN, HALF, HUGE)),
        ("result", RESULT | {"schema_version": HUGE}),
        ("result", RESULT | {"process": {"id": 3}}),
        *(("events", wrong) for wrong in (None, 3, {"a": 1}, [None], [3], [{}])),
        *(("events", [EVENT | {"at": wrong}]) for wrong in (None, "noon", "2026-01-01T00:00:00", [1])),
        *(("events", [EVENT | {"kind": wrong}]) for wrong in (None, HALF, "x" * 300)),
        ("events", [EVENT | {"data": {"x": NAN}}]),
        *(("name", wrong) for wrong in ("../../x", "/etc/x", "..", "a/b", "a\\b", "C:x", "", "x" * 256)),
        *(
            ("name", f"a{wrong}b")
            for wrong in ("\n", "\r", "\x1b", "\x7f", "\x85", "\u2028", "\u202e", "\ufeff")
        ),
        *(("type", wrong) for wrong in (None, 3, HALF, "a\nb", "")),
        ("job", JOB | {"rank": "x"}),
        *(("job", JOB | {"name": wrong}) for wrong in (NUL, HALF, 3, None, "a\nb", "\u202ex", "x" * 101)),
        *(
            ("job", JOB | {"tags": wrong})
            for wrong in ("a", [3], [""], ["a,b"], ["x" * 41], list("abcdefghijk"))
        ),
        *(("job", JOB | {"note": wrong}) for wrong in (NUL, HALF, "x" * 2001)),
        ("events", [EVENT | {"note": "x"}]),
        ("result", RESULT | {"note": "x"}),
        ("result", RESULT | {"process": {"id": "coverage"}}),
        ("result", RESULT | {"process": {"id": "coverage", "version": "1.0.0", "note": "x"}}),
        ("result", RESULT | {"schema_version": 2}),
        ("result", RESULT | {"provenance": {}}),
        ("result", RESULT | {"process": {"id": "benchmark", "version": "1.0.0"}}),
        ("result", RESULT | {"inputs": {"a": 2}}),
        ("result", RESULT | {"inputs": {}}),
        ("result", RESULT | {"inputs": {"a": [1]}}),
        ("job", JOB | {"inputs": {"a": True}}),
        ("manifest", {"note": "x"}),
        ("manifest", {"files": {"note.txt": {"sha256": "", "size": 0}}}),
    ],
)
def test_parts_that_no_job_has_are_refused(part: str, value: Any) -> None:
    with pytest.raises(InvalidInput, match="bundle"):
        unpack(sealed(**{part: value}))


@pytest.mark.parametrize("name", ["created_at", "started_at", "finished_at", "updated_at"])
@pytest.mark.parametrize("time", ["0001-01-01T00:00:00+14:00", "9999-12-31T23:59:59.999999-14:00"])
def test_a_time_beyond_the_years_is_refused_at_its_field(name: str, time: str) -> None:
    with pytest.raises(
        InvalidInput, match=f"^bundle.job.{name}: required a time within the years 1 to 9999 in UTC"
    ):
        unpack(sealed(job=JOB | {name: time}))
    with pytest.raises(InvalidInput, match=r"^bundle\.events\.0\.at: required a time within the years"):
        unpack(sealed(events=[EVENT | {"at": time}]))


def test_inputs_that_the_job_leaves_to_their_defaults_are_no_contradiction() -> None:
    assert unpack(sealed(result=RESULT | {"inputs": {"a": 1, "b": 2}})).job["inputs"] == {"a": 1}


def test_a_field_twice_is_refused() -> None:
    """One reader would see a job that was dismissed, the next one that succeeded."""
    with zipfile.ZipFile(io.BytesIO(sealed())) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    files["job.json"] = b'{"status": "dismissed", ' + files["job.json"][1:]
    manifest = json.loads(files["manifest.json"])
    entry = {"sha256": sha256(files["job.json"]).hexdigest(), "size": len(files["job.json"])}
    manifest["files"]["job.json"] = entry
    files["manifest.json"] = json.dumps(manifest).encode()
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w") as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    with pytest.raises(InvalidInput, match=r'job\.json holds an object with the name "status" twice'):
        unpack(target.getvalue())


def test_a_page_that_says_something_else_is_told(tmp_path: Path) -> None:
    """Readers open the page, and a manifest can be written for any page."""
    data, seal = pack(Bundle(JOB, RESULT, [EVENT], (PICTURE,)))
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    files["index.html"] = files["index.html"].replace(b"successful", b"proved safe")
    manifest = json.loads(files["manifest.json"])
    entry = {"sha256": sha256(files["index.html"]).hexdigest(), "size": len(files["index.html"])}
    manifest["files"]["index.html"] = entry
    files["manifest.json"] = json.dumps(manifest).encode()
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    url, file = f"sqlite:///{tmp_path / 'other.sqlite3'}", tmp_path / "job.zip"
    for whole, told in ((data, False), (target.getvalue(), True)):
        file.write_bytes(whole)
        found = CliRunner().invoke(build(), ["import", str(file), "--database-url", url])
        assert found.exit_code == 0, found.output
        assert ("index.html is not the page" in found.stderr) is told
    with pytest.raises(InvalidInput, match="its seal is"):
        unpack(target.getvalue(), seal)


def test_what_unpack_does_not_see_the_database_refuses_in_words(database: Database) -> None:
    for wrong in (Bundle(JOB | {"attempts": HUGE}, RESULT, [], ()), Bundle(JOB, RESULT, [{"at": 3}], ())):
        with pytest.raises(InvalidInput, match="bundle"):
            Transfer(database).add(wrong)
    assert JobRepository(database).list().jobs == ()


def test_a_damaged_archive_of_every_compression_is_refused() -> None:
    for compression in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA):
        whole = sealed(compression)
        for place in range(30, len(whole), 37):
            damaged = bytearray(whole)
            damaged[place] ^= 0xFF
            try:
                unpack(bytes(damaged))
            except InvalidInput:
                continue


def test_an_archive_that_unpacks_to_too_much_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("safestart.records.bundle.MOST_BYTES", 10**6)
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("manifest.json", bytes(2 * 10**6))
    assert len(target.getvalue()) < 10**4
    with pytest.raises(InvalidInput, match="unpacks to more than"):
        unpack(target.getvalue())
    twice = io.BytesIO()
    with zipfile.ZipFile(twice, "w") as archive:
        archive.writestr("manifest.json", b"{}")
        with pytest.warns(UserWarning, match="Duplicate"):
            archive.writestr("manifest.json", b"[]")
    with pytest.raises(InvalidInput, match="a name occurs twice"):
        unpack(twice.getvalue())

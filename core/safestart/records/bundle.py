"""One finished job as one file that opens without a server: a ZIP with a manifest of the SHA-256 of every part.

``manifest.json`` names format, job and files; the SHA-256 of the manifest itself, the seal, stands for the whole
bundle: a reader who has the seal from a trusted place can detect any change.
"""

from __future__ import annotations

import io
import json
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from typing import Any

from safestart.errors import InvalidInput
from safestart.records.artifact import Artifact
from safestart.records.bundle_page import page
from safestart.records.bundle_parts import event_facts, job_facts, require_names, require_result
from safestart.records.comparable import canonical, digest
from safestart.runtime.plain_json import NameTwice, loads

FORMAT, VERSION = "safestart-bundle", 1
MOST_BYTES = 1024**3
"""A bundle, packed or not."""
MOST_MEMBERS = 1000
# Zeros pack a thousandfold, results and pictures do not; a small bundle may.
_MOST_GROWTH, _SMALL = 30, 64 * 1024**2
# Commas, colons and opening brackets: a bound on what a parser would build. The largest results have 100 000 starts.
_MOST_VALUES = {
    "job.json": 1_000_000,
    "events.json": 400_000,
    "result.json": 4_000_000,
    "manifest.json": 100_000,
}
_LONGEST_DOCUMENT = 128 * 1024**2
MANIFEST = "manifest.json"
_FOLDER = "artifacts/"
_EPOCH = (1980, 1, 1, 0, 0, 0)  # no packing time: the same job gives the same bytes
_MANIFEST = {"format", "version", "job", "result_sha256", "files", "media_types"}
_FILE = {"sha256", "size"}
_DOCUMENTS = {"job.json", "events.json", "result.json", "index.html"}
_REQUIRED = "a bundle as `safestart export` writes it"


@dataclass(frozen=True, slots=True)
class Bundle:
    """A finished job: facts of its row, result document (None when it failed), events, artifacts."""

    job: dict[str, Any]
    result: dict[str, Any] | None
    events: list[dict[str, Any]]
    artifacts: tuple[Artifact, ...]


def pack(bundle: Bundle) -> tuple[bytes, str]:
    """The file and its seal."""
    # In canonical order: the order of keys depends on where a document was stored.
    job, result, events = (json.loads(canonical(part)) for part in (bundle.job, bundle.result, bundle.events))
    files = {
        "job.json": _text(job),
        "events.json": _text(events),
        "index.html": page(job, result, events, bundle.artifacts).encode(),
        **{_FOLDER + item.name: item.data for item in bundle.artifacts},
    }
    if result is not None:
        files["result.json"] = _text(result)
    manifest = {
        "format": FORMAT,
        "version": VERSION,
        "job": bundle.job["id"],
        "result_sha256": None if bundle.result is None else digest(bundle.result),
        "files": {
            name: {"sha256": sha256(data).hexdigest(), "size": len(data)} for name, data in files.items()
        },
        "media_types": {item.name: item.media_type for item in bundle.artifacts},
    }
    files[MANIFEST] = _text(manifest)
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            archive.writestr(zipfile.ZipInfo(name, _EPOCH), files[name], zipfile.ZIP_DEFLATED)
    return target.getvalue(), sha256(files[MANIFEST]).hexdigest()


def unpack(data: bytes, seal: str | None = None) -> Bundle:
    """Open a bundle; raises ``InvalidInput`` that names every part that differs from the manifest.

    With ``seal`` the manifest must have that SHA-256.
    """
    files = _read(data)
    if MANIFEST not in files:
        raise _refused("there is no manifest.json")
    found = sha256(files[MANIFEST]).hexdigest()
    if seal is not None and seal.lower() != found:
        raise _refused(f"its seal is {found}, not {seal}")
    manifest = _json(files, MANIFEST)
    wrong = _differences(manifest, files)
    if wrong:
        raise _refused("; ".join(wrong))
    job, events = _json(files, "job.json"), _json(files, "events.json")
    result = _json(files, "result.json") if "result.json" in files else None
    job_facts(job)
    event_facts(events)
    require_names(manifest["media_types"].items())
    if result is not None:
        require_result(result)
    artifacts = tuple(
        Artifact(name, media_type, files[_FOLDER + name])
        for name, media_type in manifest["media_types"].items()
    )
    wrong = _contradictions(manifest, job, result, artifacts)
    if wrong:
        raise _refused("; ".join(wrong))
    return Bundle(job, result, events, artifacts)


def own_page(data: bytes, bundle: Bundle) -> bool:
    """Whether this version renders the same page from the job; nothing else checks what the page says."""
    there = _read(data).get("index.html")
    return there is None or there == page(bundle.job, bundle.result, bundle.events, bundle.artifacts).encode()


def _read(data: bytes) -> dict[str, bytes]:
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            infos = archive.infolist()
            most = min(MOST_BYTES, max(_SMALL, _MOST_GROWTH * len(data)))
            if sum(info.file_size for info in infos) > most:
                raise _refused(f"it unpacks to more than {most} bytes")
            if len(infos) > MOST_MEMBERS:
                raise _refused(f"it holds more than {MOST_MEMBERS} files")
            if len({info.filename for info in infos}) != len(infos):
                raise _refused("a name occurs twice")
            # Others, such as LZMA, may ask for any memory to unpack with.
            if any(info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED) for info in infos):
                raise _refused("a file is packed in another way than stored or deflated")
            return {info.filename: archive.read(info) for info in infos}
    except (
        zipfile.BadZipFile,
        zlib.error,
        OSError,
        ValueError,
        EOFError,
        RuntimeError,
    ) as error:
        raise _refused(f"it cannot be unpacked ({error})") from None


def _differences(manifest: Any, files: Mapping[str, bytes]) -> list[str]:
    """The parts that differ from the manifest."""
    try:
        if (manifest["format"], manifest["version"]) != (FORMAT, VERSION):
            return [f"format {manifest['format']!r} version {manifest['version']!r} is unknown"]
        listed = {name: (entry["sha256"], entry["size"]) for name, entry in manifest["files"].items()}
        artifacts = {_FOLDER + name for name, _ in manifest["media_types"].items()}
        unknown = [
            *(set(manifest) - _MANIFEST),
            *(k for e in manifest["files"].values() for k in set(e) - _FILE),
        ]
    except (KeyError, TypeError, AttributeError):
        return ["its manifest is incomplete"]
    wrong = [f"its manifest has an unknown field {name!r}" for name in sorted(unknown)]
    wrong += [
        f"{name} is missing" for name in sorted({"job.json", "events.json", *listed, *artifacts} - set(files))
    ]
    known = {*_DOCUMENTS, *artifacts}
    wrong += [f"{name} is not in the manifest" for name in sorted(set(files) - set(listed) - {MANIFEST})]
    wrong += [f"{name} does not belong in a bundle" for name in sorted(set(listed) - known)]
    for name in sorted(set(listed) & set(files)):
        there, size = sha256(files[name]).hexdigest(), len(files[name])
        if (there, size) != listed[name]:
            wrong.append(
                f"{name} was altered: SHA-256 {there}, {size} bytes; the manifest says "
                f"SHA-256 {listed[name][0]}, {listed[name][1]} bytes"
            )
    return wrong


def _contradictions(manifest: Any, job: Any, result: Any, artifacts: tuple[Artifact, ...]) -> list[str]:
    """Parts that contradict each other although each matches the manifest."""
    if job["id"] != manifest.get("job"):
        return ["job.json belongs to another job"]
    if (job["status"] == "successful") is (result is None):
        return [f"a {job['status']} job {'without' if result is None else 'with'} a result"]
    if result is None:
        return [f"artifact {item.name} without a result" for item in artifacts]
    if digest(result) != manifest.get("result_sha256"):
        return ["result.json has another content hash than the manifest says"]
    if result["process"]["id"] != job["process_id"]:
        return ["result.json belongs to another process than job.json"]
    # The result has all inputs, defaults included; the job has only those that the client sent.
    wrong = [
        f"job.json and result.json differ in {path}" for path in _unlike(job["inputs"], result["inputs"])
    ]
    made = result["provenance"]["artifacts"]
    other = {item.name for item in artifacts if made.get(item.name) != item.sha256} | (
        set(made) - {item.name for item in artifacts}
    )
    return wrong + [
        f"artifact {name} is not the one that the result's provenance names" for name in sorted(other)
    ]


def _unlike(asked: Any, used: Any, path: str = "inputs") -> list[str]:
    """Where the inputs sent differ from the inputs used."""
    if isinstance(asked, dict) and isinstance(used, dict):
        absent = [f"{path}.{name}" for name in asked if name not in used]
        return absent + [p for n in asked if n in used for p in _unlike(asked[n], used[n], f"{path}.{n}")]
    if isinstance(asked, list) and isinstance(used, list) and len(asked) == len(used):
        pairs = enumerate(zip(asked, used, strict=True))
        return [line for i, (a, b) in pairs for line in _unlike(a, b, f"{path}[{i}]")]
    same = asked == used and isinstance(asked, bool) is isinstance(used, bool)
    return [] if same else [path]


def _json(files: Mapping[str, bytes], name: str) -> Any:
    data = files[name]
    if len(data) > _LONGEST_DOCUMENT:
        raise _refused(f"{name} is longer than {_LONGEST_DOCUMENT} bytes")
    if sum(data.count(mark) for mark in (b",", b":", b"{", b"[")) > _MOST_VALUES[name]:
        raise _refused(f"{name} holds more than {_MOST_VALUES[name]} values and names")
    try:
        return loads(data)
    except NameTwice as error:
        raise _refused(f"{name} holds {error}") from None
    except (ValueError, RecursionError):
        raise _refused(f"{name} is not JSON") from None


def _text(document: Any) -> bytes:
    return canonical(document).encode()


def _refused(what: str) -> InvalidInput:
    detail = f"bundle: required {_REQUIRED}, received one that is not: {what}"
    return InvalidInput(detail, field="bundle", required=_REQUIRED)

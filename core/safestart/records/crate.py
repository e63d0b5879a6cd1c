"""A finished job as an RO-Crate: a ZIP that describes itself in JSON-LD, for repositories of research data.

`ro-crate-metadata.json` follows RO-Crate 1.1 and the profile Process Run Crate 0.5: the job is a CreateAction whose
instrument is this software, its object the inputs, its result the document and the files. It is written as plain JSON:
the same job gives the same bytes, and the library for crates (``rocrate``, with which the tests read them) would bring
HTTP, templates and date parsing into the record of work.
"""

from __future__ import annotations

import io
import json
import zipfile
from hashlib import sha256
from typing import Any
from urllib.parse import quote

from safestart.records.bundle import Bundle
from safestart.records.bundle_parts import origin_of
from safestart.records.comparable import canonical

METADATA = "ro-crate-metadata.json"
PROFILE = "https://w3id.org/ro/wfrun/process/0.5"
_CONTEXT = ["https://w3id.org/ro/crate/1.1/context", {"sha256": "https://schema.org/sha256"}]
_SOFTWARE = "#safestart"
_ACTION = "#run"
_NO_LICENCE = "No licence is stated; ask whoever ran this job."
_ENDS = {"successful": "Completed", "failed": "Failed", "dismissed": "Failed"}
_EPOCH = (1980, 1, 1, 0, 0, 0)  # no packing time: the same job gives the same bytes


def pack_crate(bundle: Bundle, licence: str | None = None) -> bytes:
    """The crate of an ended job as ZIP; ``licence`` is the address (or the words) of the licence of its content."""
    files = {"inputs.json": ("application/json", _text(bundle.job["inputs"]))}
    if bundle.result is not None:
        files["result.json"] = ("application/json", _text(bundle.result))
    files |= {f"artifacts/{one.name}": (one.media_type, one.data) for one in bundle.artifacts}
    described = json.dumps(_described(bundle, files, licence or _NO_LICENCE), indent=1, ensure_ascii=False)
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in [
            (METADATA, described.encode()),
            *((name, data) for name, (_, data) in files.items()),
        ]:
            archive.writestr(zipfile.ZipInfo(name, _EPOCH), data, zipfile.ZIP_DEFLATED)
    return target.getvalue()


def _described(bundle: Bundle, files: dict[str, tuple[str, bytes]], licence: str) -> dict[str, Any]:
    job = bundle.job
    ended = str(job["finished_at"] or job["updated_at"])
    title = job.get("name") or f"{job['process_id']} of {ended[:10]}"
    root = {
        "@id": "./",
        "@type": "Dataset",
        "conformsTo": _to(PROFILE),
        "name": title,
        "description": job.get("note")
        or f"A run of the safestart process {job['process_id']}, {job['status']}.",
        "identifier": job["id"],
        "datePublished": ended,
        "license": _to(licence) if licence.startswith("http") else licence,
        "hasPart": [_to(_address(name)) for name in files],
        "mentions": _to(_ACTION),
        **({"keywords": ", ".join(job["tags"])} if job.get("tags") else {}),
    }
    metadata = {
        "@id": METADATA,
        "@type": "CreativeWork",
        "conformsTo": _to("https://w3id.org/ro/crate/1.1"),
        "about": _to("./"),
    }
    profile = {"@id": PROFILE, "@type": "CreativeWork", "name": "Process Run Crate", "version": "0.5"}
    graph = [metadata, root, profile, _action(bundle, files), _software(bundle)]
    if licence.startswith("http"):
        graph.append({"@id": licence, "@type": "CreativeWork", "name": licence})
    graph += [_file(name, media_type, data) for name, (media_type, data) in files.items()]
    return {"@context": _CONTEXT, "@graph": graph}


def _action(bundle: Bundle, files: dict[str, tuple[str, bytes]]) -> dict[str, Any]:
    job = bundle.job
    times = {"startTime": job["started_at"], "endTime": job["finished_at"]}
    problem = {} if job["problem"] is None else {"error": job["problem"].get("detail") or job["message"]}
    return {
        "@id": _ACTION,
        "@type": "CreateAction",
        "name": f"{job['process_id']}, job {job['id']}",
        "instrument": _to(_SOFTWARE),
        "object": [_to("inputs.json")],
        "result": [_to(_address(name)) for name in files if name != "inputs.json"],
        "actionStatus": _to(f"http://schema.org/{_ENDS[job['status']]}ActionStatus"),
        **{name: str(value) for name, value in times.items() if value is not None},
        **problem,
    }


def _software(bundle: Bundle) -> dict[str, Any]:
    """This software as it ran: the version of the package, and the SHA-256 of its source as identifier."""
    origin = None if bundle.result is None else origin_of(bundle.result)
    packages, source = ({}, None) if origin is None else (origin.packages, origin.source_sha256)
    return {
        "@id": _SOFTWARE,
        "@type": "SoftwareApplication",
        "name": "safestart",
        "description": f"Process {bundle.job['process_id']}",
        **({"softwareVersion": packages["safestart"]} if packages.get("safestart") else {}),
        **({"identifier": f"urn:sha256:{source}"} if source else {}),
        **(
            {"softwareRequirements": [f"{name} {version}" for name, version in sorted(packages.items())]}
            if packages
            else {}
        ),
    }


def _file(name: str, media_type: str, data: bytes) -> dict[str, Any]:
    return {
        "@id": _address(name),
        "@type": "File",
        "name": name.rpartition("/")[2],
        "encodingFormat": media_type,
        "contentSize": str(len(data)),
        "sha256": sha256(data).hexdigest(),
    }


def _address(name: str) -> str:
    return quote(name)


def _to(address: str) -> dict[str, str]:
    return {"@id": address}


def _text(document: Any) -> bytes:
    return canonical(document).encode()

"""Where a result comes from, as PROV-JSON (W3C), for OGC API - Processes Part 4, class Provenance.

The job is the activity. It used the inputs, followed the process as its plan, and generated the result and its files.
The software that computed it is the agent, with versions and the SHA-256 of its source; it acted for the key that
submitted.
"""

from __future__ import annotations

from typing import Any
from urllib.parse import quote

from safestart.records.bundle_parts import origin_of
from safestart.store.records import Job, JobStatus


def provenance(job: Job, record: dict[str, Any] | None, base: str) -> dict[str, Any]:
    """The provenance of a job; ``record`` is its stored result, None while there is none."""
    activity, inputs, plan = f"jobs:{job.id}", "job:inputs", f"processes:{job.process_id}"
    times = {"prov:startTime": job.started_at, "prov:endTime": job.finished_at}
    document: dict[str, Any] = {
        "prefix": {
            "safestart": "urn:safestart:",
            "jobs": f"{base}/jobs/",
            "job": f"{base}/jobs/{job.id}/",
            "processes": f"{base}/processes/",
        },
        "entity": {inputs: {"prov:type": "prov:Entity"}, plan: {"prov:type": "prov:Plan"}},
        "activity": {
            activity: {
                **{name: value for name, value in times.items() if value is not None},
                "safestart:status": job.status.value,
                "safestart:attempts": job.attempts,
            }
        },
        "used": {"_:used": {"prov:activity": activity, "prov:entity": inputs}},
        "wasAssociatedWith": {"_:plan": {"prov:activity": activity, "prov:plan": plan}},
    }
    if job.submitter:
        submitter = f"safestart:key:{job.submitter}"
        document["agent"] = {submitter: {"prov:type": "prov:Agent"}}
        document["wasAssociatedWith"]["_:submitter"] = {"prov:activity": activity, "prov:agent": submitter}
    if record is not None and job.status is JobStatus.SUCCESSFUL:
        _add_result(document, activity, plan, record, job.submitter)
    return document


def _add_result(
    document: dict[str, Any], activity: str, plan: str, record: dict[str, Any], submitter: str | None
) -> None:
    origin = origin_of(record)
    software = f"safestart:software:{origin.source_sha256 or 'unknown'}"
    known = {"python": origin.python, "source_sha256": origin.source_sha256}
    document.setdefault("agent", {})[software] = {
        "prov:type": "prov:SoftwareAgent",
        **{f"safestart:{name}": value for name, value in known.items() if value},
        **{f"safestart:package:{name}": value for name, value in origin.packages.items()},
    }
    document["wasAssociatedWith"]["_:plan"]["prov:agent"] = software
    if submitter:
        delegate = {"prov:delegate": software, "prov:responsible": f"safestart:key:{submitter}"}
        document["actedOnBehalfOf"] = {"_:delegation": {**delegate, "prov:activity": activity}}
    document["entity"][plan] |= {"safestart:version": record.get("process", {}).get("version", "unknown")}
    made = {"job:results": {"prov:type": "prov:Entity", "safestart:sha256": record["sha256"]}}
    for file in record["artifacts"]:
        made[f"job:artifacts/{quote(file['name'], safe='')}"] = {
            "prov:type": "prov:Entity",
            "safestart:sha256": file["sha256"],
            "safestart:media_type": file["media_type"],
        }
    document["entity"] |= made
    document["wasGeneratedBy"] = {
        f"_:generated{number}": {"prov:entity": name, "prov:activity": activity}
        for number, name in enumerate(made)
    }
    document["wasDerivedFrom"] = {
        "_:derived": {"prov:generatedEntity": "job:results", "prov:usedEntity": "job:inputs"}
    }

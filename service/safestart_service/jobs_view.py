"""Jobs as documents: statusInfo of OGC API - Processes 1.0 plus position, reason, ETA and links."""

from __future__ import annotations

import re
from typing import Any

from safestart.errors import NotFound
from safestart.store.records import Job, JobStatus
from safestart_service.answers import link
from safestart_service.errors import NoSuchJob
from safestart_service.state import Services

RESULTS_REL = "http://www.opengis.net/def/rel/ogc/1.0/results"
NO_WORKER = "no worker is connected; `safestart worker` starts one"
_JOB_ID = re.compile(r"[0-9A-Za-z-]{1,64}")


def known_job(services: Services, job_id: str) -> Job:
    """The job named in a path; raises ``NoSuchJob``."""
    try:
        # What cannot be an id is not put to the database (PostgreSQL refuses NUL, for one).
        if not _JOB_ID.fullmatch(job_id):
            raise NotFound(f"no job {job_id!r}")
        return services.jobs.get(job_id)
    except NotFound as error:
        raise NoSuchJob(error.detail, field="jobID", required="the id of a job", received=job_id) from None


def status_info(services: Services, job: Job, base: str, workers: int | None = None) -> dict[str, Any]:
    """statusInfo of a job; ``workers`` spares a query where many jobs are listed."""
    position = services.jobs.position(job.id) if job.status is JobStatus.ACCEPTED else None
    if position is not None and workers is None:
        workers = services.jobs.workers_alive()
    return {
        "jobID": job.id,
        "processID": job.process_id,
        "type": "process",
        "status": job.status.value,
        "message": job.message,
        "created": job.created_at,
        "started": job.started_at,
        "finished": job.finished_at,
        "updated": job.updated_at,
        "progress": int(job.progress),
        "position": position,
        "reason": waiting_reason(position, workers),
        "eta_s": job.eta_s,
        "attempts": job.attempts,
        "dismissal_requested": job.cancel_requested,
        "problem": job.problem,
        "links": _links(job, base),
    }


def job_detail(services: Services, job: Job, base: str) -> dict[str, Any]:
    """statusInfo with the inputs and the scalars of the instant answer; arrays stay out, as clients poll this."""
    instant = job.instant
    if instant is not None:
        instant = {name: value for name, value in instant.items() if not isinstance(value, list | dict)}
    return {**status_info(services, job, base), "inputs": job.inputs, "instant": instant}


def waiting_reason(position: int | None, workers: int | None) -> str | None:
    """Why a job waits, in a sentence; None when it does not wait."""
    if position is None:
        return None
    ahead = position - 1
    queue = "next in the queue" if ahead == 0 else f"{ahead} job{'s' if ahead > 1 else ''} ahead"
    if not workers:
        return f"{NO_WORKER}; {queue}"
    return f"{queue}; {workers} worker{'s' if workers > 1 else ''} connected"


def _links(job: Job, base: str) -> list[dict[str, str]]:
    here = f"{base}/jobs/{job.id}"
    links = [
        link(here, "self", "this job"),
        link(f"{here}/events", "monitor", "events while it runs", "text/event-stream"),
        link(f"{base}/dashboard/jobs/{job.id}", "alternate", "this job as a page", "text/html"),
        link(f"{base}/processes/{job.process_id}", "up", "its process"),
    ]
    if job.status is JobStatus.SUCCESSFUL:
        links.append(link(f"{here}/results", RESULTS_REL, "results, with links to the artifacts"))
    return links


def result_document(services: Services, job_id: str, base: str) -> dict[str, Any]:
    """The stored result of a job with links to its artifacts."""
    stored = services.results.result(job_id)
    return {
        "jobID": job_id,
        "schema_version": stored.schema_version,
        "sha256": stored.sha256,
        **stored.document,
        "artifacts": [
            {
                "name": info.name,
                "media_type": info.media_type,
                "size": info.size,
                "sha256": info.sha256,
                "href": f"{base}/jobs/{job_id}/artifacts/{info.name}",
            }
            for info in services.results.artifacts(job_id)
        ],
    }

"""Jobs as documents: statusInfo of OGC API - Processes 1.0 plus position, reason, ETA and links."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from safestart.errors import NotFound
from safestart.processes.registry import PROCESS_IDS, process
from safestart.store.records import Crew, Job, JobEntry, JobPage, JobStatus, Wait
from safestart_service.computing.store import Store
from safestart_service.documents.key_inputs import key_inputs
from safestart_service.errors import NoSuchJob
from safestart_service.http.answers import link

if TYPE_CHECKING:
    from safestart_service.state import Services

RESULTS_REL = "http://www.opengis.net/def/rel/ogc/1.0/results"
NO_WORKER = "no worker is connected; `safestart worker` starts one"
_JOB_ID = re.compile(r"[0-9A-Za-z-]{1,64}")


def known_job(services: Services, job_id: str) -> Job:
    """The job named in a path; raises ``NoSuchJob``."""
    try:
        # Do not query the database for an impossible id (PostgreSQL refuses NUL, for example).
        if not _JOB_ID.fullmatch(job_id):
            raise NotFound(f"no job {job_id!r}")
        return services.jobs.get(job_id)
    except NotFound as error:
        raise NoSuchJob(error.detail, field="jobID", required="the id of a job", received=job_id) from None


def status_infos(services: Services, page: JobPage, base: str) -> list[dict[str, Any]]:
    """statusInfo of each job of a page, with its place in the queue but without estimates for waiting jobs."""
    jobs = page.jobs
    places = services.jobs.positions(job.id for job in jobs if job.status is JobStatus.ACCEPTED)
    crew = services.jobs.crew()
    waits = {job_id: Wait(place, None, None) for job_id, place in places.items()}
    return [
        _status_info(job, base, waits.get(job.id), crew, inputs)
        for job, inputs in zip(jobs, page.inputs, strict=True)
    ]


def status_info(services: Services | Store, job: Job, base: str) -> dict[str, Any]:
    """statusInfo of one job; a waiting job has estimates of its start and end."""
    wait = services.jobs.wait(job.id) if job.status is JobStatus.ACCEPTED else None
    return _status_info(job, base, wait, services.jobs.crew(), job.inputs)


def _status_info(
    job: JobEntry, base: str, wait: Wait | None, crew: Crew, inputs: dict[str, Any] | None
) -> dict[str, Any]:
    return {
        "jobID": job.id,
        "processID": job.process_id,
        "type": "process",
        "status": job.status.value,
        "message": job.message,
        "created": job.created_at,
        # The standard's times must not be null, so missing ones are left out.
        **({} if job.started_at is None else {"started": job.started_at}),
        **({} if job.finished_at is None else {"finished": job.finished_at}),
        "updated": job.updated_at,
        "progress": int(job.progress),
        "position": None if wait is None else wait.position,
        "reason": waiting_reason(wait, crew),
        "starts_in_s": None if wait is None else wait.starts_in_s,
        "eta_s": job.eta_s if wait is None else wait.ends_in_s,
        "priority": job.priority,
        "attempts": job.attempts,
        "submitter": job.submitter or None,
        "dismissal_requested": job.cancel_requested,
        "problem": job.problem,
        "name": job.name,
        "tags": job.tags,
        "note": job.note,
        "outcome": job.outcome,
        "key_inputs": None if inputs is None else key_inputs(job.process_id, inputs),
        "links": _links(job, base),
    }


def job_detail(services: Services | Store, job: Job, base: str) -> dict[str, Any]:
    """statusInfo with the inputs and the scalars of the instant answer; arrays stay out, as clients poll this."""
    instant = job.instant
    if instant is not None:
        instant = {name: value for name, value in instant.items() if not isinstance(value, list | dict)}
    return {**status_info(services, job, base), "inputs": job.inputs, "instant": instant}


def waiting_reason(wait: Wait | None, crew: Crew) -> str | None:
    """One sentence on why a job waits; None when it does not wait."""
    if wait is None:
        return None
    ahead = wait.position - 1
    queue = "next in the queue" if ahead == 0 else f"{_many(ahead, 'job')} ahead"
    if wait.higher:
        queue += f", {wait.higher} of higher priority"
    if wait.turns:
        queue += f", {wait.turns} that came later, as submitters take turns"
    if not crew.workers:
        return f"{NO_WORKER}; {queue}"
    workers = f"{_many(crew.workers, 'worker')} connected"
    if not crew.places:
        return f"{queue}; {workers}, still starting"
    if crew.busy >= crew.places:
        return f"{queue}; {workers}, {crew.busy} of {_many(crew.places, 'place')} taken"
    return f"{queue}; {workers}"


def _many(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _links(job: JobEntry, base: str) -> list[dict[str, str]]:
    here = f"{base}/jobs/{job.id}"
    links = [
        link(here, "self", "this job"),
        link(f"{here}/events", "monitor", "events while it runs", "text/event-stream"),
        link(f"{base}/dashboard/jobs/{job.id}", "alternate", "this job as a page", "text/html"),
        link(f"{base}/processes/{job.process_id}", "up", "its process"),
        link(f"{here}/prov", "related", "its provenance (PROV-JSON)"),
    ]
    if job.process_id in PROCESS_IDS and process(job.process_id).sharding is not None:
        links.append(link(f"{here}/partial", "partial", "the partial result of the finished shards"))
    if job.status is JobStatus.SUCCESSFUL:
        links.append(link(f"{here}/results", RESULTS_REL, "results, with links to the artifacts"))
    return links


def partial_document(services: Services, job: Job, base: str) -> dict[str, Any]:
    """The partial result from a job's finished shards; raises ``NotFound`` for a process without shards."""
    spec = process(job.process_id)
    if spec.sharding is None:
        raise NotFound(
            f"process {spec.id} is not cut into shards, so its jobs have no partial results",
            field="jobID",
            required="a job of a process that is cut into shards",
            received=job.id,
        )
    inputs = spec.stored(job.inputs)
    documents = services.jobs.shard_documents(job.id)
    total = len(spec.sharding.parts(inputs))
    # A successful job has no shards any more: its result replaces them.
    done = total if job.status is JobStatus.SUCCESSFUL else len(documents)
    return {
        "jobID": job.id,
        "processID": job.process_id,
        "status": job.status.value,
        "shards": {"done": done, "total": total},
        "outputs": spec.sharding.so_far(inputs, documents) if documents else None,
        "links": _links(job, base),
    }


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
                "href": f"{base}/jobs/{job_id}/artifacts/{quote(info.name, safe='')}",
            }
            for info in services.results.artifacts(job_id)
        ],
    }

"""The work behind the answers, as functions of values that can be sent to another process."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any
from uuid import uuid4

import orjson

from safestart.processes.base import ProcessSpec
from safestart.processes.door import OneStart
from safestart.processes.registry import process
from safestart.runtime.access import Caller, Role
from safestart.runtime.progress import Context
from safestart_service.computing.limits import too_long
from safestart_service.computing.long_answers import Where, put
from safestart_service.computing.pieces import members, pieces
from safestart_service.computing.store import Store
from safestart_service.documents.execution import (
    ExecuteRequest,
    check_outputs,
    check_states,
    parse_request,
    selected,
)
from safestart_service.documents.jobs_view import job_detail
from safestart_service.errors import Forbidden
from safestart_service.http.body import MOST_PARTS, PARTS_PER_STATE, parse_body

LIGHT_S = 0.03
"""An answer that costs more than this is heavy."""


def _nothing(_: Any) -> dict[str, str]:
    return {}


@dataclass(frozen=True, slots=True)
class Asked:
    """A POST: ``bare`` bodies are the inputs alone, the others execution requests of the standard.

    ``queued``: it makes a job. ``wants_async``: the client asked for that.
    """

    process_id: str
    body: bytes
    base: str
    by: Caller
    bare: bool = False
    queued: bool = False
    wants_async: bool = False
    idempotency_key: str | None = None
    announced: Callable[[Any], dict[str, str]] = field(default=_nothing)
    """Further header fields of an answer, from the inputs."""
    job_id: str = field(default_factory=lambda: str(uuid4()))
    """Of the job that it makes: where a helper dies the work is done again, and makes no second one."""


@dataclass(frozen=True, slots=True)
class Made:
    """Body, status and header fields of an answer."""

    body: bytes
    status: int = 200
    headers: dict[str, str] = field(default_factory=dict)
    in_file: bool = False
    """Whether the body is in the file that the caller named."""


def one_start(store: Store, context: Context, asked: OneStart) -> dict[str, Any]:
    """The document of one start."""
    del store
    return asked.document(context)


def at_once(store: Store, context: Context, asked: Asked) -> Made | float:
    """The answer, or what it costs, s, where that is too much for a light one."""
    request = _parsed(store, asked)
    spec = process(asked.process_id)
    if asked.queued:
        return _submitted(store, spec, request, asked)
    cost = spec.cost(request.inputs)
    if cost <= LIGHT_S:
        return _answer(spec, request, context, asked)
    # A helper process loads for seconds, and compiles for a minute where no kernels are kept.
    document = spec.output_at_once(request.inputs, context)
    return cost if document is None else _made(document.items(), request, asked)


def in_full(store: Store, context: Context, asked: Asked, place: Where | None = None) -> Made:
    """The answer, whatever it costs; raises ``AnswerTimeout`` for one that would take too long.

    A long body goes into the file ``place``, or, where that is full or gone, the long way.
    """
    request = _parsed(store, asked)
    spec = process(asked.process_id)
    if asked.queued:
        return _submitted(store, spec, request, asked)
    cost, limit = spec.cost(request.inputs), store.settings.answer_timeout_s
    if cost > limit:
        raise too_long(limit, cost)
    return _answer(spec, request, context, asked, place)


def _parsed(store: Store, asked: Asked) -> ExecuteRequest:
    spec, most = process(asked.process_id), store.settings.max_states
    parts = MOST_PARTS + (PARTS_PER_STATE * most if spec.states else 0)
    if asked.bare:
        request = ExecuteRequest(inputs=parse_body(spec.inputs, asked.body, parts))
    else:
        request = parse_request(spec.id, asked.body, parts)
        check_outputs(spec, request, sync=not asked.queued)
    check_states(spec, request.inputs, most)
    return request


def _answer(
    spec: ProcessSpec, request: ExecuteRequest, context: Context, asked: Asked, place: Where | None = None
) -> Made:
    return _made(spec.output_parts(request.inputs, context), request, asked, place)


def _made(
    parts: Iterable[tuple[str, Any]], request: ExecuteRequest, asked: Asked, place: Where | None = None
) -> Made:
    headers = asked.announced(request.inputs)
    chosen = parts if asked.bare else selected(parts, request)
    raw = not asked.bare and request.response == "raw"
    if place is None:
        whole = chosen if raw else dict(chosen)
        return Made(orjson.dumps(whole, option=orjson.OPT_SERIALIZE_NUMPY), headers=headers)
    body, in_file = put(place, pieces(chosen) if raw else members(chosen))
    return Made(body, headers=headers, in_file=in_file)


def _submitted(store: Store, spec: ProcessSpec, request: ExecuteRequest, asked: Asked) -> Made:
    by = asked.by
    if request.priority > 0 and by.key_id is not None and not by.role.allows(Role.ADMIN):
        raise Forbidden(
            f"priority: required at most 0 with a key of role {by.role.value}, received {request.priority}",
            field="priority",
            required="at most 0, or a key of role admin",
            received=request.priority,
        )
    spec.require_possible(request.inputs)
    job = store.jobs.submit(
        spec.id,
        request.inputs.model_dump(mode="json"),
        instant=spec.instant_answer(request.inputs),
        timeout_s=store.settings.job_timeout_s,
        idempotency_key=asked.idempotency_key,
        priority=request.priority,
        max_queued=store.settings.max_queued,
        submitter=by.key_id or "",
        by=by,
        job_id=asked.job_id,
        labels=request.labels(),
    )
    document = job_detail(store, job, asked.base)
    if job.instant is not None:
        document["certificate"] = job.instant
    headers = {"Location": f"{asked.base}/jobs/{job.id}"}
    if asked.wants_async:
        headers["Preference-Applied"] = "respond-async"
    if job.id != asked.job_id:
        headers["Idempotency-Replayed"] = "true"
    return Made(orjson.dumps(document), 201, headers)

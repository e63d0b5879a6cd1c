"""Why a job failed, as a problem document (RFC 9457 members), without stack traces and secrets."""

from __future__ import annotations

from typing import Any

from safestart.errors import SafestartError

_PREFIX = "urn:safestart:problem:"
_SHOWN = 200


def _problem(slug: str, title: str, status: int, detail: str, **more: Any) -> dict[str, Any]:
    given = {name: value for name, value in more.items() if value is not None}
    return {"type": _PREFIX + slug, "title": title, "status": status, "detail": detail, **given}


def of_error(error: SafestartError) -> dict[str, Any]:
    """Problem for one of our errors: what was required and what came."""
    received = None if error.received is None else str(error.received)[:_SHOWN]
    return _problem(
        error.slug,
        error.title,
        error.status,
        error.detail,
        field=error.field,
        required=error.required,
        received=received,
    )


def of_unexpected(error: BaseException, incident: str) -> dict[str, Any]:
    """Problem for an unexpected error; ``incident`` finds its stack trace in the worker's log."""
    detail = (
        f"the computation ended with an unexpected {type(error).__name__}; the worker's log has {incident}"
    )
    return _problem("internal", "Internal error", 500, detail, id=incident)


def of_timeout(timeout_s: float) -> dict[str, Any]:
    """Problem for a job that exceeded its time limit."""
    return _problem(
        "timeout",
        "Time limit exceeded",
        500,
        f"the job was stopped after {timeout_s:g} s, its time limit",
        required=f"an end within {timeout_s:g} s",
    )


def of_other_source(ours: str, theirs: str) -> dict[str, Any]:
    """Problem for a job whose parts were computed by different code, so its result has no single source."""
    return _problem(
        "other-source",
        "Different code",
        500,
        f"the worker runs source {ours[:12]} of safestart, one of its task processes {theirs[:12]}; restart them "
        "with the same source",
        required=ours,
        received=theirs,
    )


def of_poison(deaths: int) -> dict[str, Any]:
    """Problem for a job with a task that killed its processes."""
    return _problem(
        "poison",
        "Too many attempts",
        500,
        f"{deaths} task processes in a row died while they ran one shard of this job (memory limit or crash); "
        "not tried again",
    )

"""Errors that a caller can cause or meet, under one root; each message says what was required and what came.

Bad input raises one of these. A numerical failure does not: it is a result code
(:class:`safestart.engines.base.ResultCode`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


class SafestartError(Exception):
    """Root of all errors raised on purpose.

    ``status`` is the HTTP status the service answers with and ``slug`` the last part of the problem type
    (RFC 9457), so that one handler maps every error.
    """

    status = 500
    slug = "internal"
    title = "Internal error"

    def __init__(
        self, detail: str, *, field: str | None = None, required: str | None = None, received: Any = None
    ) -> None:
        super().__init__(detail)
        self.detail = detail
        self.field = field
        self.required = required
        self.received = received

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle with the keyword arguments: errors cross process boundaries."""
        return _rebuild, (type(self), self.detail, self.field, self.required, self.received)


def _rebuild(
    kind: type[SafestartError], detail: str, field: str | None, required: str | None, received: Any
) -> SafestartError:
    return kind(detail, field=field, required=required, received=received)


class InvalidInput(SafestartError):
    """A value outside what the method is defined for."""

    status = 422
    slug = "invalid-input"
    title = "Invalid input"


class NotFound(SafestartError):
    """A process, job, result or artifact that does not exist."""

    status = 404
    slug = "not-found"
    title = "Not found"


class Conflict(SafestartError):
    """A request that the present state of a job does not allow."""

    status = 409
    slug = "conflict"
    title = "Conflict"


class LeaseLost(Conflict):
    """A worker lost its lease on a job; the store refuses its further writes."""

    slug = "lease-lost"
    title = "Lease lost"


class IdempotencyMismatch(SafestartError):
    """A request reused an idempotency key with another body."""

    status = 422
    slug = "idempotency-mismatch"
    title = "Idempotency key used with another request"


class ResultNotReady(NotFound):
    """The results of a job that has not ended yet (the name is OGC API - Processes 1.0's)."""

    slug = "result-not-ready"
    title = "Result not ready"


class JobFailed(NotFound):
    """The results of a job that failed; the detail is the reason of the failure."""

    slug = "job-failed"
    title = "The job failed"


class UnfitResult(SafestartError):
    """A result does not match its process description, so it is not stored, or not shown where it is stored."""

    slug = "unfit-result"
    title = "The result does not fit its description"


class Misregistered(SafestartError):
    """An entry of a registry that cannot work: whoever added the part must mend it."""

    slug = "misregistered"
    title = "A part of safestart is registered wrongly"


class Altered(SafestartError):
    """A stored result whose SHA-256 differs from the one stored with it; the service does not return it."""

    slug = "altered"
    title = "The stored result was altered"


class Unavailable(SafestartError):
    """Something this request needs (database, optional package, port) is missing."""

    status = 503
    slug = "unavailable"
    title = "Unavailable"


class Away(Unavailable):
    """A server does not answer now but may answer later: a caller may wait for it."""


class QueueFull(Unavailable):
    """The queue is full; try again later."""

    status = 429
    slug = "queue-full"
    title = "Queue full"


class Cancelled(SafestartError):
    """Raised inside a process when its context says that the job was dismissed."""

    status = 409
    slug = "cancelled"
    title = "Cancelled"


def invalid(field: str, required: str, received: Any) -> InvalidInput:
    """Build the usual :class:`InvalidInput`: field, what was required, what came."""
    shown = repr(received)
    if len(shown) > 120:
        shown = shown[:117] + "..."
    return InvalidInput(
        f"{field}: required {required}, received {shown}", field=field, required=required, received=received
    )


def named(field: str, read: Callable[P, T], *arguments: P.args, **options: P.kwargs) -> T:
    """What ``read`` returns; its :class:`InvalidInput` goes under the ``field`` that held what it read."""
    try:
        return read(*arguments, **options)
    except InvalidInput as error:
        detail = f"{field}: {error.detail}"
        raise InvalidInput(detail, field=field, required=error.required, received=error.received) from None

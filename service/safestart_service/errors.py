"""Errors of the HTTP layer; the others are in :mod:`safestart.errors`."""

from __future__ import annotations

from safestart.errors import NotFound, SafestartError


class NoSuchJob(NotFound):
    """The path names an unknown job."""

    slug = "no-such-job"
    title = "No such job"


class NoSuchProcess(NotFound):
    """The path names an unknown process."""

    slug = "no-such-process"
    title = "No such process"


class MalformedBody(SafestartError):
    """The body is not JSON in UTF-8."""

    status = 400
    slug = "malformed-body"
    title = "Malformed body"


class MalformedRequest(SafestartError):
    """The bytes are not an HTTP request."""

    status = 400
    slug = "malformed-request"
    title = "Malformed request"


class BodyTooLarge(SafestartError):
    """The body, declared or streamed, exceeds ``max_body_bytes``."""

    status = 413
    slug = "body-too-large"
    title = "Body too large"


class QueryTooLong(SafestartError):
    """The query string is longer than any question needs."""

    status = 414
    slug = "query-too-long"
    title = "Query too long"


class Unauthorized(SafestartError):
    """The request has no key that is in force; all reasons get the same message."""

    status = 401
    slug = "unauthorized"
    title = "API key required"


class Forbidden(SafestartError):
    """The key is in force but its role is not enough."""

    status = 403
    slug = "forbidden"
    title = "Not allowed with this key"


class NotAcceptable(SafestartError):
    """The service offers none of the media types that the caller accepts."""

    status = 406
    slug = "not-acceptable"
    title = "Not acceptable"


class RequestTimeout(SafestartError):
    """The head or the body did not arrive in time."""

    status = 408
    slug = "request-timeout"
    title = "Request timeout"


class Misdirected(SafestartError):
    """The Host header names another server: a wrong proxy, or a page that rebinds its own name to us."""

    status = 421
    slug = "misdirected-request"
    title = "Not this host"


class RateLimited(SafestartError):
    """One key or address sent too many requests."""

    status = 429
    slug = "rate-limited"
    title = "Too many requests"


class AnswerTimeout(SafestartError):
    """An answer at once that takes longer than the service lets clients wait."""

    status = 504
    slug = "answer-timeout"
    title = "The answer takes too long"


class Busy(SafestartError):
    """The requests in flight fill the memory that the service has for them."""

    status = 503
    slug = "busy"
    title = "Too many requests in flight"


class TooManyConnections(SafestartError):
    """No place is left for the connection."""

    status = 503
    slug = "too-many-connections"
    title = "Too many connections"


class HeadTooLarge(SafestartError):
    """The request line and headers are longer than any request needs."""

    status = 431
    slug = "headers-too-large"
    title = "Headers too large"


class UnknownCoding(SafestartError):
    """The body comes in a transfer coding that the service does not undo."""

    status = 501
    slug = "not-implemented"
    title = "Not implemented"


class UnsupportedMediaType(SafestartError):
    """The body's content type is not JSON, or the body is compressed."""

    status = 415
    slug = "unsupported-media-type"
    title = "Unsupported media type"

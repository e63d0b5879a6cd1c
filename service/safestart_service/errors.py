"""Errors that only the HTTP face can meet; the others are in :mod:`safestart.errors`."""

from __future__ import annotations

from safestart.errors import NotFound, SafestartError


class NoSuchJob(NotFound):
    """The path names a job that the store does not hold."""

    slug = "no-such-job"
    title = "No such job"


class NoSuchProcess(NotFound):
    """The path names a process that is not offered."""

    slug = "no-such-process"
    title = "No such process"


class MalformedBody(SafestartError):
    """A body that is not JSON in UTF-8."""

    status = 400
    slug = "malformed-body"
    title = "Malformed body"


class MalformedRequest(SafestartError):
    """Bytes that are no HTTP request."""

    status = 400
    slug = "malformed-request"
    title = "Malformed request"


class BodyTooLarge(SafestartError):
    """A body beyond ``max_body_bytes``, declared or streamed."""

    status = 413
    slug = "body-too-large"
    title = "Body too large"


class QueryTooLong(SafestartError):
    """A query string longer than any question needs."""

    status = 414
    slug = "query-too-long"
    title = "Query too long"


class Unauthorized(SafestartError):
    """No key, or none that is in force; all reasons get the same words."""

    status = 401
    slug = "unauthorized"
    title = "API key required"


class Forbidden(SafestartError):
    """A key in force whose role is not enough."""

    status = 403
    slug = "forbidden"
    title = "Not allowed with this key"


class NotAcceptable(SafestartError):
    """None of the media types that the caller takes is offered."""

    status = 406
    slug = "not-acceptable"
    title = "Not acceptable"


class RequestTimeout(SafestartError):
    """A head or a body that did not come in time."""

    status = 408
    slug = "request-timeout"
    title = "Request timeout"


class Misdirected(SafestartError):
    """A Host header that names another server: a wrong proxy, or a page that rebinds a name of its own to us."""

    status = 421
    slug = "misdirected-request"
    title = "Not this host"


class RateLimited(SafestartError):
    """More requests than one key or one address may send."""

    status = 429
    slug = "rate-limited"
    title = "Too many requests"


class TooManyConnections(SafestartError):
    """A connection for which there is no place."""

    status = 503
    slug = "too-many-connections"
    title = "Too many connections"


class HeadTooLarge(SafestartError):
    """A request line and headers longer than any request needs."""

    status = 431
    slug = "headers-too-large"
    title = "Headers too large"


class UnsupportedMediaType(SafestartError):
    """A body whose content type is not JSON, or that is compressed."""

    status = 415
    slug = "unsupported-media-type"
    title = "Unsupported media type"

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


class UnsupportedMediaType(SafestartError):
    """A body whose content type is not JSON."""

    status = 415
    slug = "unsupported-media-type"
    title = "Unsupported media type"

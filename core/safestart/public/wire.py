"""HTTP between `Client` and a service: requests, refusals as exceptions, files with their digests."""

from __future__ import annotations

import time
from collections.abc import Mapping
from ipaddress import ip_address
from typing import Any
from urllib.parse import quote, urlsplit

import httpx

from safestart import errors
from safestart.errors import Altered, Away, SafestartError, invalid
from safestart.model.strict_json import json_of
from safestart.records.artifact import Artifact
from safestart.runtime.plain_json import NameTwice, NoNumber, loads

TIMEOUT_S = 60.0
_TRIES, _PAUSE_S = 5, 0.5
_BY_SLUG = {
    kind.slug: kind
    for kind in vars(errors).values()
    if isinstance(kind, type) and issubclass(kind, SafestartError)
}
_BY_STATUS = {404: errors.NotFound, 409: errors.Conflict, 422: errors.InvalidInput, 503: errors.Unavailable}


class Wire:
    """One service; answers are JSON documents, refusals our exceptions."""

    def __init__(self, url: str, key: str | None, timeout_s: float, http: httpx.Client | None) -> None:
        parts = urlsplit(url)
        if parts.scheme not in ("http", "https") or not parts.hostname:
            raise invalid("url", "an address as http://127.0.0.1:8000", url)
        self._base = url.rstrip("/")
        self._headers = {"Authorization": f"Bearer {key}"} if key else {}
        self._own = http is None
        # A proxy of the environment cannot reach this machine's own service.
        self._http = http or httpx.Client(timeout=timeout_s, trust_env=not _is_here(parts.hostname))

    def close(self) -> None:
        """Close our own connections."""
        if self._own:
            self._http.close()

    def get(self, path: str, headers: Mapping[str, str] | None = None) -> dict[str, Any]:
        """GET a JSON document; tries again when the service does not answer."""
        return _document(self.answered("GET", path, None, headers, again=True))

    def post(
        self, path: str, body: Any, headers: Mapping[str, str] | None = None, *, again: bool = False
    ) -> dict[str, Any]:
        """POST JSON and read JSON; ``again`` allows a second try, for harmless repetitions only."""
        return _document(self.answered("POST", path, body, headers, again=again))

    def answered(
        self, method: str, path: str, body: Any, headers: Mapping[str, str] | None, *, again: bool
    ) -> httpx.Response:
        """The answer to a request that was not refused."""
        for left in range(_TRIES - 1 if again else 0, -1, -1):
            try:
                answer = self._http.request(
                    method,
                    self._base + path,
                    json=body,
                    headers={"Accept": "*/*", **self._headers, **(headers or {})},
                )
                break
            except httpx.TransportError as error:
                if not left:
                    raise Away(
                        f"{self._base}: required a service that answers ({type(error).__name__}: {error})"
                    ) from None
                time.sleep(_PAUSE_S)
        if answer.is_success or answer.status_code == httpx.codes.NOT_MODIFIED:
            return answer
        raise _refusal(answer)


def sent(inputs: Mapping[str, Any] | None) -> Any:
    """Inputs as JSON, NumPy's numbers and arrays too; raises ``InvalidInput`` for what JSON cannot hold."""
    if not isinstance(inputs, Mapping | None):
        raise invalid("inputs", "an object of names and values", inputs)
    try:
        return loads(json_of(dict(inputs or {})))
    except NoNumber as error:
        raise invalid("inputs", error.required, error.text) from None
    except NameTwice as error:  # 1 and "1" are one name in JSON
        raise invalid("inputs", "every name once in an object", error.name) from None


def artifact_of(wire: Wire, job: str, entry: Mapping[str, Any]) -> Artifact:
    """A file of a job's result; raises ``Altered`` if its bytes differ from those that the document names."""
    name = str(entry["name"])
    answer = wire.answered("GET", f"{job}/artifacts/{quote(name, safe='')}", None, None, again=True)
    found = Artifact(name, str(entry["media_type"]), answer.content)
    if found.sha256 != entry["sha256"]:
        raise Altered(f"{name}: required SHA-256 {entry['sha256']}, received {found.sha256}")
    return found


def _is_here(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _document(answer: httpx.Response) -> dict[str, Any]:
    try:
        found = answer.json()
    except ValueError:
        found = None
    if not isinstance(found, dict):
        raise Away(f"{answer.request.url}: required a JSON document, received something else")
    return found


def _refusal(answer: httpx.Response) -> SafestartError:
    """The exception for a problem document; without a document, for the status."""
    try:
        problem = answer.json()
    except ValueError:
        problem = {}
    if not isinstance(problem, dict):
        problem = {}
    slug = str(problem.get("type", "")).replace(":", "/").rpartition("/")[2]
    kind = _BY_SLUG.get(slug) or _BY_STATUS.get(answer.status_code, SafestartError)
    detail = problem.get("detail") or f"the service answered {answer.status_code}"
    return kind(
        str(detail),
        field=problem.get("field"),
        required=problem.get("required"),
        received=problem.get("received"),
    )

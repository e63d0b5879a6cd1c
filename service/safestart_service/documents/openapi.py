"""The OpenAPI description: FastAPI's paths, with our models, problem responses and the processes' schemas."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from safestart.processes.go_no_go.one_start import GoNoGoAnswer
from safestart.processes.registry import PROCESS_IDS, process
from safestart.processes.start_in_space.one_start import SpaceAnswer
from safestart.runtime.access import Role
from safestart_service.access.gate import needed_role
from safestart_service.documents import access_schemas, deprecation, schemas
from safestart_service.documents.estimate import Estimate
from safestart_service.documents.execution import execute_model
from safestart_service.documents.problems import MEDIA_TYPE, Problem

REF = "#/components/schemas/"
TAG = "For If-None-Match."
ANSWERS: tuple[type[BaseModel], ...] = (
    Problem,
    GoNoGoAnswer,
    SpaceAnswer,
    schemas.Landing,
    schemas.Conformance,
    schemas.ProcessList,
    schemas.ProcessDescription,
    schemas.JobList,
    schemas.JobDetail,
    schemas.Partial,
    schemas.Submitted,
    schemas.JobInputs,
    Estimate,
    schemas.ResultDocument,
    schemas.Partial,
    schemas.Health,
    schemas.Readiness,
    access_schemas.CallerDocument,
    access_schemas.KeyList,
    access_schemas.NewKeyDocument,
    access_schemas.KeyDocument,
    access_schemas.AuditList,
)
_WHY = {
    304: "The caller has this content already (If-None-Match).",
    400: "The body is not JSON, Host is invalid, or a single-valued header is repeated.",
    401: "Keys are in use, and the request has none that is in force.",
    403: "The key's role is not enough.",
    404: "Nothing has this name.",
    406: "None of the media types in Accept is offered.",
    408: "The body did not arrive in time.",
    409: "The current state of the job does not allow it.",
    413: "The body is too large.",
    414: "The query is too long.",
    415: "The body is not declared as JSON.",
    421: "The Host header names another server.",
    422: "An input is invalid; the problem names it.",
    429: "Too many requests or streams with this key, or too many jobs wait; Retry-After says when.",
    500: "An unexpected error.",
    501: "The body has a transfer coding other than chunked.",
    503: "The database does not answer, or the service or its machine is full; Retry-After says when.",
    504: "The answer would take too long, or was not there in time; make a job of it.",
}


HERE = {"url": "http://127.0.0.1:8000", "description": "A service on this machine."}
_TAGS = {
    "instant answers": "Answered at once, without a job.",
    "processes": "What can be run: descriptions and execution.",
    "jobs": "Queued executions: status, events, dismissal.",
    "results": "Results and files of jobs.",
    "provenance": "How a result came about.",
    "service": "The service itself and its description.",
    "operations": "Health and metrics.",
    "administration": "Keys and the audit log.",
    "dashboard": "Pages.",
}


def answer(model: type[BaseModel], text: str, **headers: str) -> dict[str, Any]:
    """A JSON response of a route, for FastAPI's ``responses``."""
    return content("application/json", {"$ref": REF + model.__name__}, text, **headers)


def content(media_type: str, schema: dict[str, Any], text: str, **headers: str) -> dict[str, Any]:
    """A response of any media type."""
    found: dict[str, Any] = {"description": text, "content": {media_type: {"schema": schema}}}
    if headers:
        found["headers"] = {
            name.replace("_", "-"): {"description": why, "schema": {"type": "string"}}
            for name, why in headers.items()
        }
    return found


def refusals(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Problem responses of a route; every route can refuse a query, fail, and find no room."""
    found: dict[int | str, dict[str, Any]] = {}
    for status in sorted({*statuses, 414, 422, 500, 503}):
        if status == 304:
            found[status] = {"description": _WHY[status]}
        else:
            found[status] = content(MEDIA_TYPE, {"$ref": REF + "Problem"}, _WHY[status])
    return found


def json_body(
    models: dict[str, type[BaseModel]], examples: dict[str, Any], title: str | None = None
) -> dict[str, Any]:
    """``openapi_extra`` of a route that parses its body itself: any of the models, with named examples.

    A body of several models needs a title: generators of clients make a class of it.
    """
    references = [{"$ref": REF + model.__name__} for model in models.values()]
    if (title is None) != (len(references) == 1):
        raise AssertionError(f"required a title for a body of several models alone, received {title}")
    schema = references[0] if title is None else {"title": title, "type": "object", "anyOf": references}
    named = {name: {"summary": name, "value": value} for name, value in examples.items()}
    return {
        "requestBody": {
            "required": True,
            "content": {"application/json": {"schema": schema, "examples": named}},
        }
    }


_SECURITY_SCHEMES = {
    "bearer": {"type": "http", "scheme": "bearer", "description": "An API key."},
    "header": {"type": "apiKey", "in": "header", "name": "X-API-Key", "description": "An API key."},
}
_QUEUE_TEXT = " To queue a job: role `submit`."
_ROLE_TEXT = "Needs a key with role `{role}` once keys are in use."


def _add_access(document: dict[str, Any]) -> None:
    """The role that the gate requires for each operation, and its refusals."""
    document["components"]["securitySchemes"] = _SECURITY_SCHEMES
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            role = needed_role(method.upper(), path)
            queues = path.endswith("/execution")
            statuses = {400, 421} | ({408, 501} if "requestBody" in operation else set())
            if role is None:
                operation["security"] = []
            else:
                operation["security"] = [{name: []} for name in _SECURITY_SCHEMES]
                statuses |= {401, 429} | ({403} if role is not Role.READ or queues else set())
                text = operation.get("description", "")
                needs = _ROLE_TEXT.format(role=role.value) + (_QUEUE_TEXT if queues else "")
                operation["description"] = f"{text}\n\n{needs}".strip()
            for status in statuses:
                problem = content(MEDIA_TYPE, {"$ref": REF + "Problem"}, _WHY[status])
                operation["responses"].setdefault(str(status), problem)
            operation["responses"] = dict(sorted(operation["responses"].items()))


def build(app: FastAPI) -> dict[str, Any]:
    """Build the whole document; the caller stores it."""
    document = get_openapi(
        title=app.title, version=app.version, description=app.description, routes=app.routes
    )
    specs = [process(name) for name in PROCESS_IDS]
    inputs = [model for spec in specs for model in (spec.inputs, execute_model(spec.id))]
    inputs += [access_schemas.KeyRequest, schemas.JobLabels]
    outputs = [*ANSWERS, *(spec.outputs for spec in specs)]
    components: dict[str, Any] = document.setdefault("components", {}).setdefault("schemas", {})
    described = [
        models_json_schema([(model, "validation") for model in inputs], ref_template=REF + "{model}"),
        models_json_schema([(model, "serialization") for model in outputs], ref_template=REF + "{model}"),
    ]
    for _, found in described:
        for name, schema in found["$defs"].items():
            if components.setdefault(name, schema) != schema:
                raise AssertionError(f"two different schemas are called {name}")
    names = [name for name in components if "__" in name]
    if names:
        raise AssertionError(f"two models share a name: {', '.join(names)}")
    _drop_foreign(document)
    _name_bodies(document)
    _close_tuples(document)
    _add_access(document)
    deprecation.mark(document)
    document["servers"] = [HERE]
    document["tags"] = [{"name": name, "description": text} for name, text in _TAGS.items()]
    return document


def _drop_foreign(document: dict[str, Any]) -> None:
    """Remove FastAPI's own 422, which this service never sends, and its models."""
    for operations in document["paths"].values():
        for operation in operations.values():
            if "HTTPValidationError" in str(operation["responses"].get("422")):
                del operation["responses"]["422"]
    for name in ("HTTPValidationError", "ValidationError"):
        document["components"]["schemas"].pop(name, None)


def _name_bodies(document: dict[str, Any]) -> None:
    """Make a schema with a name of each body of several models.

    Without one a generator names its class after the first call that takes it, and a new call changes that name.
    """
    schemas = document["components"]["schemas"]
    for operations in document["paths"].values():
        for operation in operations.values():
            for media in operation.get("requestBody", {}).get("content", {}).values():
                schema = media["schema"]
                if "anyOf" in schema:
                    if schemas.setdefault(schema["title"], schema) != schema:
                        raise AssertionError(f"two different schemas are called {schema['title']}")
                    media["schema"] = {"$ref": REF + schema["title"]}


def _close_tuples(node: Any) -> None:
    """Give arrays of fixed length the member ``items``, without which many tools take no array."""
    if isinstance(node, dict):
        if "prefixItems" in node:
            node.setdefault("items", node["prefixItems"][0])
        node = list(node.values())
    for item in node if isinstance(node, list) else ():
        _close_tuples(item)


def at(document: dict[str, Any], base: str) -> dict[str, Any]:
    """The description of the service at this address."""
    return document | {"servers": [{"url": base, "description": "this service"}]}


def install(app: FastAPI) -> None:
    """Make ``app.openapi()`` return our document, built once."""

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            app.openapi_schema = build(app)
        return app.openapi_schema

    app.openapi = openapi  # type: ignore[method-assign]

"""The instant verdict: one start by GET, up to 100 000 by POST."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated, Any

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response

from safestart.errors import NotFound
from safestart.processes.go_no_go import run
from safestart.processes.go_no_go.method_registry import PROVING, RENAMED, method_of
from safestart.processes.go_no_go.one_start import ONE_START, GoNoGoAnswer
from safestart.processes.go_no_go.spec import SPEC, GoNoGoInputs, GoNoGoOutputs
from safestart.processes.start_in_space.spec import SPEC as SPACE
from safestart.processes.start_in_space.spec import SpaceInputs, SpaceOutputs
from safestart.runtime.progress import Context
from safestart_service.documents.deprecation import RENAMED_METHOD
from safestart_service.documents.execution import check_states, run_now
from safestart_service.documents.openapi import REF, answer, content, json_body, refusals
from safestart_service.http.answers import Json
from safestart_service.http.body import parse_body, read_body
from safestart_service.http.computing import computed
from safestart_service.http.lean import query_route
from safestart_service.state import services

if TYPE_CHECKING:
    from pydantic import BaseModel as GoNoGoQuery
else:
    GoNoGoQuery = ONE_START.query("GoNoGoQuery", "One operating point and one start, flat.")
_SILENT = Context()


def _document(inputs: GoNoGoInputs, context: Context) -> dict[str, Any]:
    return run.answer(inputs, context).document_of_one()


def _instant(inputs: GoNoGoInputs, query: bytes) -> dict[str, Any] | None:
    """The document of a question that takes microseconds, else None: a cone program would block other requests."""
    found = run.at_once(inputs, _SILENT)
    return None if found is None else _linked(found.document_of_one(), inputs, query)


async def _answer(request: Request, inputs: GoNoGoInputs) -> Response:
    document = await computed(request, lambda context: _document(inputs, context))
    return Json(_linked(document, inputs, request.scope["query_string"]))


def _linked(document: dict[str, Any], inputs: GoNoGoInputs, query: bytes) -> dict[str, Any]:
    """The answer with the address of a proof of the same question; none for what is undecided or not sound."""
    if document["verdict"] != "UNDECIDED" and method_of(inputs.method).sound:
        document["proof_url"] = f"/go-no-go/proof?{query.decode('latin-1')}"
    return document


async def _proof(request: Request, inputs: GoNoGoInputs) -> Response:
    method = inputs.method if method_of(inputs.method).proves else PROVING
    asked = inputs.model_copy(update={"method": method, "proofs": True})
    document = await computed(request, lambda context: _document(asked, context))
    if document["proof"] is None:
        raise NotFound(
            f"there is no proof: {document['reason']}",
            required="a start that is decided",
            received="UNDECIDED",
        )
    return Json(document["proof"], headers={"Content-Disposition": 'attachment; filename="proof.json"'})


def in_space(body: bytes) -> bool:
    """Whether a body asks about ``starts``, the question in space."""
    if b'"starts"' not in body:
        return False
    try:
        found = json.loads(body)
    except (ValueError, RecursionError):
        return False
    return isinstance(found, dict) and "starts" in found


one = APIRouter(tags=["instant answers"], route_class=query_route(ONE_START.parse, _answer, _instant))
proof = APIRouter(tags=["instant answers"], route_class=query_route(ONE_START.parse, _proof))
many = APIRouter(tags=["instant answers"])


@one.get(
    "/go-no-go",
    summary="Go/no-go for one start",
    responses={200: answer(GoNoGoAnswer, "The verdict and every margin it rests on."), **refusals(422)},
)
async def go_no_go_one(_query: Annotated[GoNoGoQuery, Query()]) -> Response:
    """May a chaser at rest at this point start its approach?

    No GO without a proof: a certificate in closed form says GO at once, for ever, or an atlas or a cone program
    decides; ``decided_by`` says which. ``method=paper`` asks the paper's conditions, which are not sound. A start
    outside the corridor is NO_GO; ``violated_faces`` says where.
    """
    raise AssertionError("its route class answers")


@proof.get(
    "/go-no-go/proof",
    summary="Only the proof of a go/no-go",
    responses={
        200: content("application/json", {"type": "object"}, "The document that `safestart verify` checks."),
        **refusals(404, 422),
    },
)
async def go_no_go_proof(_query: Annotated[GoNoGoQuery, Query()]) -> Response:
    """The proof of the exact answer to the same question, as a file for ``safestart verify``.

    It is computed anew from the question (milliseconds), so the link holds as long as the service does. 404 when the
    start is UNDECIDED.
    """
    raise AssertionError("its route class answers")


@many.post(
    "/go-no-go",
    summary="Go/no-go for many starts",
    openapi_extra=json_body(
        {SPEC.id: GoNoGoInputs, SPACE.id: SpaceInputs}, {SPEC.id: SPEC.example, SPACE.id: SPACE.example}
    ),
    responses={
        200: content(
            "application/json",
            {"anyOf": [{"$ref": REF + GoNoGoOutputs.__name__}, {"$ref": REF + SpaceOutputs.__name__}]},
            "Arrays over the states, or over the starts.",
        ),
        **refusals(400, 413, 415, 422),
    },
)
async def go_no_go_many(request: Request) -> Response:
    """The same question for up to 100 000 starts of one operating point.

    With ``starts`` in place of ``states`` it is the question of process ``start-in-space``: states with velocities, any
    attitude, orbit, corridor and set of thrusts.
    """
    body = await read_body(request)
    found = services(request)

    def respond(context: Context) -> Response:
        if in_space(body):
            asked = parse_body(SpaceInputs, body)
            check_states(SPACE, asked, found.settings.max_states)
            return Json(run_now(SPACE, asked, context))
        inputs = parse_body(GoNoGoInputs, body)
        check_states(SPEC, inputs, found.settings.max_states)
        answered = Json(run_now(SPEC, inputs, context))
        if inputs.method in RENAMED:
            answered.raw_headers.extend(RENAMED_METHOD.headers())
        return answered

    return await computed(request, respond)

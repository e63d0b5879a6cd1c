"""The instant verdict: one start by GET, up to 100 000 by POST."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Annotated, Any

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response
from starlette.types import Scope

from safestart.errors import NotFound
from safestart.processes import door
from safestart.processes.door import OneStart
from safestart.processes.flat import described
from safestart.processes.go_no_go.method_registry import RENAMED
from safestart.processes.go_no_go.one_start import GoNoGoAnswer
from safestart.processes.go_no_go.spec import SPEC, GoNoGoInputs, GoNoGoOutputs
from safestart.processes.start_in_space.missions import MISSIONS
from safestart.processes.start_in_space.one_start import SpaceAnswer
from safestart.processes.start_in_space.spec import SPEC as SPACE
from safestart.processes.start_in_space.spec import SpaceInputs, SpaceOutputs
from safestart.runtime.progress import Context
from safestart_service.computing.dispatch import one_document, posted
from safestart_service.documents.deprecation import RENAMED_METHOD
from safestart_service.documents.openapi import REF, content, json_body, refusals
from safestart_service.http.answers import Json, root_path
from safestart_service.http.body import read_body
from safestart_service.http.lean import query_route
from safestart_service.http.strict import StrictRoute

if TYPE_CHECKING:
    from pydantic import BaseModel as GoNoGoQuery
else:
    GoNoGoQuery = described(door.PARAMETERS, "GoNoGoQuery", "One operating point and one start, flat.")
_SILENT = Context()


def _instant(asked: OneStart, scope: Scope) -> dict[str, Any] | None:
    """The document of a question that takes microseconds, else None: a cone program would block other requests."""
    document = asked.at_once(_SILENT)
    return None if document is None else _linked(document, asked, scope)


async def _answer(request: Request, asked: OneStart) -> Response:
    document = await one_document(request, asked)
    return Json(_linked(document, asked, request.scope))


def _linked(document: dict[str, Any], asked: OneStart, scope: Scope) -> dict[str, Any]:
    """The answer with the address of a proof of the same question; none for what is undecided or not sound."""
    if document["verdict"] != "UNDECIDED" and asked.sound():
        query = scope["query_string"].decode("latin-1")
        document["proof_url"] = f"{scope.get('root_path', '')}/go-no-go/proof?{query}"
    return document


async def _proof(request: Request, asked: OneStart) -> Response:
    document = await one_document(request, asked.with_proof())
    if document["proof"] is None:
        verdict, by = document["verdict"], document.get("decided_by")
        raise NotFound(
            f"there is no proof document: {document['reason']}",
            required="a start that is decided by more than a theorem" if by else "a start that is decided",
            received=f"{verdict} by {by}" if by else verdict,
        )
    return Json(document["proof"], headers={"Content-Disposition": 'attachment; filename="proof.json"'})


def in_space(body: bytes) -> bool:
    """Whether a body asks about ``starts``, the question in space; the body is not parsed for that."""
    return b'"starts"' in body


one = APIRouter(tags=["instant answers"], route_class=query_route(door.read, _answer, _instant))
proof = APIRouter(tags=["instant answers"], route_class=query_route(door.read, _proof))
many = APIRouter(tags=["instant answers"], route_class=StrictRoute)


@one.get(
    "/go-no-go",
    operation_id="goNoGo",
    summary="Go/no-go for one start",
    responses={
        200: content(
            "application/json",
            {"anyOf": [{"$ref": REF + GoNoGoAnswer.__name__}, {"$ref": REF + SpaceAnswer.__name__}]},
            "The verdict and every margin it rests on.",
        ),
        **refusals(422, 429, 503, 504),
    },
)
async def go_no_go_one(_query: Annotated[GoNoGoQuery, Query()]) -> Response:
    """May a chaser at rest at this point start its approach? With ``position_m``: may one that arrives like this?

    No GO without a proof: a certificate in closed form says GO at once, for ever, or a cone program or an atlas
    decides; ``decided_by`` says which. ``method=paper`` asks the paper's conditions, which are not sound. A start
    outside the corridor is NO_GO; ``violated_faces`` says where.

    With ``position_m`` in place of ``x_m`` and ``y_m`` it is the question of process ``start-in-space``: a velocity, a
    spin of either sign and any phase; ``attitude``, ``orbit``, ``corridor`` and ``thrust`` as JSON objects.
    """
    raise AssertionError("its route class answers")


@proof.get(
    "/go-no-go/proof",
    operation_id="getGoNoGoProof",
    summary="Only the proof of a go/no-go",
    responses={
        200: content("application/json", {"type": "object"}, "The document that `safestart verify` checks."),
        **refusals(404, 422, 429, 503, 504),
    },
)
async def go_no_go_proof(_query: Annotated[GoNoGoQuery, Query()]) -> Response:
    """The proof of the exact answer to the same question, as a file for ``safestart verify``.

    It is computed anew from the question (milliseconds), so the link holds as long as the service does. It never
    contradicts a GO by `certified`: where no thrust held over 2 s stays, it holds the thrust over shorter steps. 404
    when the start is UNDECIDED, or its GO is the theorem's and no thrust held over such steps shows it.
    """
    raise AssertionError("its route class answers")


@many.post(
    "/go-no-go",
    operation_id="goNoGoMany",
    summary="Go/no-go for many starts",
    openapi_extra=json_body(
        {SPEC.id: GoNoGoInputs, SPACE.id: SpaceInputs},
        {SPEC.id: SPEC.example, SPACE.id: SPACE.example, **MISSIONS},
        "GoNoGoRequest",
    ),
    responses={
        200: content(
            "application/json",
            {"anyOf": [{"$ref": REF + GoNoGoOutputs.__name__}, {"$ref": REF + SpaceOutputs.__name__}]},
            "Arrays over the states, or over the starts.",
        ),
        **refusals(400, 413, 415, 422, 429, 503, 504),
    },
)
async def go_no_go_many(request: Request) -> Response:
    """The same question for up to 100 000 starts of one operating point.

    With ``starts`` in place of ``states`` it is the question of process ``start-in-space``: states with velocities, any
    attitude, orbit, corridor and set of thrusts.
    """
    if in_space(await read_body(request)):
        return await posted(request, SPACE.id, bare=True)
    return await posted(request, SPEC.id, bare=True, announced=partial(_renamed, root_path(request)))


def _renamed(root: str, inputs: GoNoGoInputs) -> dict[str, str]:
    """Header fields for a deprecated name of a method."""
    return RENAMED_METHOD.fields(root) if inputs.method in RENAMED else {}

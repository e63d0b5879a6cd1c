"""The instant verdict: one start by GET, up to 100 000 by POST."""

from __future__ import annotations

import asyncio
from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response

from safestart.processes.go_no_go.spec import SPEC, GoNoGoInputs, GoNoGoOutputs
from safestart_service.answers import Json
from safestart_service.body import parse_body, read_body
from safestart_service.execute import check_states, run_now
from safestart_service.instant import GoNoGoAnswer, GoNoGoQuery, flat_answer
from safestart_service.lean import query_route
from safestart_service.openapi import answer, json_body, refusals
from safestart_service.state import services


async def _answer(query: GoNoGoQuery) -> Response:
    # The closed form takes microseconds; a cone program would hold up every other request.
    at_once = query.method == "closed_form"
    return Json(flat_answer(query) if at_once else await asyncio.to_thread(flat_answer, query))


one = APIRouter(tags=["instant answers"], route_class=query_route(GoNoGoQuery, _answer))
many = APIRouter(tags=["instant answers"])


@one.get(
    "/go-no-go",
    summary="Go/no-go for one start",
    responses={200: answer(GoNoGoAnswer, "The verdict and every margin it rests on."), **refusals(422)},
)
async def go_no_go_one(query: Annotated[GoNoGoQuery, Query()]) -> Response:
    """May a chaser at rest at this point start its approach?

    By the paper's closed form, where NO_GO means not certified and GO is no proof, or with ``method=exact`` by a cone
    program that proves either. A start outside the corridor is NO_GO; ``violated_faces`` says where.
    """
    return await _answer(query)


@many.post(
    "/go-no-go",
    summary="Go/no-go for many starts",
    openapi_extra=json_body({SPEC.id: GoNoGoInputs}, {SPEC.id: SPEC.example}),
    responses={200: answer(GoNoGoOutputs, "Arrays over the states."), **refusals(400, 413, 415, 422)},
)
async def go_no_go_many(request: Request) -> Response:
    """The same question for up to 100 000 starts of one operating point."""
    body = await read_body(request)
    most = services(request).settings.max_states

    def respond() -> Response:
        inputs = parse_body(GoNoGoInputs, body)
        check_states(inputs, most)
        return Json(run_now(SPEC, inputs))

    return await asyncio.to_thread(respond)

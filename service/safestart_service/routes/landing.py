"""Landing page, conformance, and the description of the API itself."""

from __future__ import annotations

from fastapi import APIRouter, Request
from fastapi.responses import RedirectResponse, Response

from safestart_service.documents.openapi import TAG, answer, at, content, refusals
from safestart_service.documents.openapi30 import older
from safestart_service.documents.schemas import Conformance, Landing
from safestart_service.http.answers import Json, base_url, link, root_path, tagged
from safestart_service.http.strict import StrictRoute
from safestart_service.pages import render as pages

router = APIRouter(tags=["service"], route_class=StrictRoute)

OPENAPI_TYPE = "application/vnd.oai.openapi+json;version={}"
CONFORMANCE_REL = "http://www.opengis.net/def/rel/ogc/1.0/conformance"
PROCESSES_REL = "http://www.opengis.net/def/rel/ogc/1.0/processes"
JOBS_REL = "http://www.opengis.net/def/rel/ogc/1.0/job-list"
_PART_1 = "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/"
_PART_4 = "http://www.opengis.net/spec/ogcapi-processes-4/1.0/conf/"
CLASSES = (
    *(_PART_1 + name for name in ("core", "ogc-process-description", "json", "oas30", "job-list", "dismiss")),
    _PART_4 + "provenance",
)


@router.get(
    "/",
    operation_id="getLandingPage",
    summary="Landing page",
    responses={
        200: answer(Landing, "Links to everything."),
        303: {"description": "A browser is sent to the dashboard."},
        **refusals(),
    },
)
async def landing(request: Request) -> Response:
    """Links to everything; a browser is sent to the dashboard."""
    base = base_url(request)
    if pages.wanted(request):
        return RedirectResponse(f"{base}/dashboard", 303, headers={"Vary": "Accept"})
    links = [
        link(f"{base}/", "self", "this page"),
        link(f"{base}/openapi.json", "service-desc", "OpenAPI 3.1 description", OPENAPI_TYPE.format("3.1")),
        link(
            f"{base}/openapi-3.0.json", "service-desc", "OpenAPI 3.0 description", OPENAPI_TYPE.format("3.0")
        ),
        link(f"{base}/docs", "service-doc", "the calls as a page", "text/html"),
        link(f"{base}/conformance", CONFORMANCE_REL, "conformance classes"),
        link(f"{base}/processes", PROCESSES_REL, "processes"),
        link(f"{base}/jobs", JOBS_REL, "jobs"),
        link(f"{base}/go-no-go", "related", "go/no-go for one start"),
        link(f"{base}/dashboard", "alternate", "dashboard", "text/html"),
    ]
    document = {"title": request.app.title, "description": request.app.description, "links": links}
    return Json(document, headers={"Vary": "Accept"})


@router.get(
    "/conformance",
    operation_id="getConformance",
    summary="Conformance classes",
    responses={200: answer(Conformance, "Classes.", ETag=TAG), **refusals(304)},
)
async def conformance(request: Request) -> Response:
    """Conformance classes of OGC API - Processes that this service implements."""
    return tagged(request, {"conformsTo": list(CLASSES)})


@router.get("/openapi.json", include_in_schema=False)
def openapi(request: Request) -> Response:
    """The OpenAPI description."""
    return tagged(request, at(request.app.openapi(), base_url(request)))


@router.get("/openapi-3.0.json", include_in_schema=False)
def openapi_3_0(request: Request) -> Response:
    """The same in OpenAPI 3.0."""
    return tagged(request, older(at(request.app.openapi(), base_url(request))))


@router.get(
    "/docs",
    operation_id="getDocsPage",
    summary="The calls as a page",
    responses={200: content("text/html", {"type": "string"}, "A page."), **refusals()},
)
def docs(request: Request) -> Response:
    """The OpenAPI description as a page that needs neither script nor network."""
    return pages.docs(request.app.openapi(), root_path(request))

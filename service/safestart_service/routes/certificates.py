"""The closed-form certificate of an operating point on a grid."""

from __future__ import annotations

from fastapi import APIRouter, Request
from fastapi.responses import Response

from safestart.processes.certificate.spec import SPEC, CertificateInputs, CertificateOutputs
from safestart_service.documents.execution import run_now
from safestart_service.documents.openapi import answer, json_body, refusals
from safestart_service.http.answers import Json
from safestart_service.http.body import parse_body, read_body
from safestart_service.http.computing import computed

router = APIRouter(tags=["instant answers"])


@router.post(
    "/certificates",
    summary="Closed-form certificate on a grid",
    openapi_extra=json_body({SPEC.id: CertificateInputs}, {SPEC.id: SPEC.example}),
    responses={200: answer(CertificateOutputs, "Mask and margins."), **refusals(400, 413, 415, 422)},
)
async def certificates(request: Request) -> Response:
    """Synchronization radius, safe fraction of the corridor, mask and margin of every grid point."""
    body = await read_body(request)
    return await computed(
        request, lambda context: Json(run_now(SPEC, parse_body(CertificateInputs, body), context))
    )

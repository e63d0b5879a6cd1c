"""The closed-form certificate of an operating point on a grid."""

from __future__ import annotations

from fastapi import APIRouter, Request
from fastapi.responses import Response

from safestart.processes.certificate.spec import SPEC, CertificateInputs, CertificateOutputs
from safestart_service.computing.dispatch import posted
from safestart_service.documents.openapi import answer, json_body, refusals
from safestart_service.http.strict import StrictRoute

router = APIRouter(tags=["instant answers"], route_class=StrictRoute)


@router.post(
    "/certificates",
    operation_id="certify",
    summary="Closed-form certificate on a grid",
    openapi_extra=json_body({SPEC.id: CertificateInputs}, {SPEC.id: SPEC.example}),
    responses={
        200: answer(CertificateOutputs, "Mask and margins."),
        **refusals(400, 413, 415, 422, 429, 503, 504),
    },
)
async def certificates(request: Request) -> Response:
    """Synchronization radius, safe fraction of the corridor, mask and margin of every grid point."""
    return await posted(request, SPEC.id, bare=True)

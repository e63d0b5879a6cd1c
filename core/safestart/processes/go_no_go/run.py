"""Run go-no-go: certify all states at once and say why."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safestart.certificates.closed_form import Certificate, certify
from safestart.errors import invalid
from safestart.processes.base import ProcessOutput
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.processes.wire import NO_SYNC_LIMIT, finite
from safestart.progress import Context
from safestart.scenario import Floats

OUTSIDE = "outside the corridor"


def run(inputs: GoNoGoInputs, context: Context) -> ProcessOutput:
    """Answer for every state; planar and spatial states may not be mixed."""
    certificate = certify(inputs.scenario(), _points(inputs), inputs.rest)
    context.step(1, 1)
    limit = certificate.range_limit
    document: dict[str, Any] = {
        "method": "closed_form",
        "rest": inputs.rest.value,
        "r_sync_m": finite(limit),
        "r_sync_reason": None if math.isfinite(limit) else NO_SYNC_LIMIT,
        "faces": list(certificate.faces),
        "verdict": ["GO" if safe else "NO_GO" for safe in certificate.safe.tolist()],
        "margin_m": certificate.margin.tolist(),
        "face_margins_m": certificate.face_margin.tolist(),
        "range_margin_m": [finite(value) for value in certificate.range_margin.tolist()],
        **_explain(certificate),
    }
    return ProcessOutput(document)


def _points(inputs: GoNoGoInputs) -> Floats:
    spatial = [state.z_m is not None for state in inputs.states]
    if any(spatial) and not all(spatial):
        raise invalid("states", "z_m in every state or in none", f"z_m in {sum(spatial)} of {len(spatial)}")
    if spatial[0]:
        return np.array([(state.x_m, state.y_m, state.z_m) for state in inputs.states])
    return np.array([(state.x_m, state.y_m) for state in inputs.states])


def _explain(certificate: Certificate) -> dict[str, list[Any]]:
    """Binding constraint, faces violated by the start itself, and a sentence per state."""
    binding: list[str] = []
    outside: list[list[str]] = []
    reason: list[str] = []
    faces = certificate.faces
    for slack, face_margin, range_margin, margin in zip(
        certificate.slack.tolist(),
        certificate.face_margin.tolist(),
        certificate.range_margin.tolist(),
        certificate.margin.tolist(),
        strict=True,
    ):
        tight = min(range(len(faces)), key=face_margin.__getitem__)
        name = "range" if range_margin <= face_margin[tight] else faces[tight]
        violated = [face for face, value in zip(faces, slack, strict=True) if value < 0.0]
        if violated:
            name = name if name in violated else violated[0]
            text = f"{OUTSIDE}: violates {', '.join(violated)}"
        elif margin > 0.0:
            text = f"certified with {margin:.2f} m to spare at {name}"
        elif name == "range":
            text = f"{-range_margin:.2f} m beyond the range within which the rotation can be matched"
        else:
            text = f"the rotation consumes the slack of {name} before full thrust arrests it ({-margin:.2f} m short)"
        binding.append(name)
        outside.append(violated)
        reason.append(text)
    return {"binding": binding, "violated_faces": outside, "reason": reason}

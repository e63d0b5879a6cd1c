"""Run go-no-go: certify all states at once and say why."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safestart.closed_form.explain import explain
from safestart.closed_form.paper import Certificate, certify
from safestart.errors import invalid
from safestart.model.scenario import Floats
from safestart.processes.base import ProcessOutput
from safestart.processes.go_no_go.question_fields import refuse_closed_form
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.processes.wire import NO_SYNC_LIMIT, finite
from safestart.runtime.progress import Context


def run(inputs: GoNoGoInputs, context: Context) -> ProcessOutput:
    """Answer for every state; planar and spatial states may not be mixed."""
    points = _points(inputs)
    if inputs.method == "closed_form":
        refuse_closed_form(inputs)
    certificate = certify(inputs.scenario(), points, inputs.rest)
    limit = certificate.range_limit
    document: dict[str, Any] = {
        "method": inputs.method,
        "question": inputs.question,
        "rest": inputs.rest.value,
        "r_sync_m": finite(limit),
        "r_sync_reason": None if math.isfinite(limit) else NO_SYNC_LIMIT,
        "faces": list(certificate.faces),
        "verdict": ["GO" if safe else "NO_GO" for safe in certificate.safe.tolist()],
        "margin_m": certificate.margin.tolist(),
        "face_margins_m": certificate.face_margin.tolist(),
        "range_margin_m": [finite(value) for value in certificate.range_margin.tolist()],
        **_explain(certificate),
        "end_s": None,
        "examples": None,
        "proof": None,
    }
    if inputs.method == "closed_form":
        context.step(1, 1)
    else:
        # The solver is loaded where it is asked for: the closed form answers without it.
        from safestart.processes.go_no_go.proved import prove_all

        document |= prove_all(inputs, points, context)
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
    told = [
        explain(certificate.faces, slack, face_margin, range_margin, margin)
        for slack, face_margin, range_margin, margin in zip(
            certificate.slack.tolist(),
            certificate.face_margin.tolist(),
            certificate.range_margin.tolist(),
            certificate.margin.tolist(),
            strict=True,
        )
    ]
    binding, violated, reason = (list(column) for column in zip(*told, strict=True))
    return {"binding": binding, "violated_faces": violated, "reason": reason}


_PER_STATE = ("verdict", "margin_m", "range_margin_m", "binding", "violated_faces", "reason")


def single(outputs: dict[str, Any]) -> dict[str, Any]:
    """The outputs of one state, flat: no array around each value, face margins by name."""
    margins = dict(zip(outputs["faces"], outputs["face_margins_m"][0], strict=True))
    shared = {key: outputs[key] for key in ("r_sync_m", "r_sync_reason", "method", "question", "rest")}
    listed = {key: outputs[key] and outputs[key][0] for key in ("end_s", "examples", "proof")}
    return {key: outputs[key][0] for key in _PER_STATE} | {"face_margins_m": margins} | listed | shared

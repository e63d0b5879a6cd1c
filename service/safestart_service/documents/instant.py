"""The instant answer for one start: query parameters in, one flat document out."""

from __future__ import annotations

import math
from typing import Any, Literal

from pydantic import Field

from safestart.closed_form.explain import explain
from safestart.closed_form.paper_point import certify_point, prepare
from safestart.model.scenario import MAX_MEAN_MOTION, MAX_RANGE, Rest
from safestart.processes.base import WireModel
from safestart.processes.go_no_go.question_fields import Asked, Kind, Method, refuse_closed_form
from safestart.processes.go_no_go.run import run, single
from safestart.processes.go_no_go.spec import GoNoGoInputs, StateInput
from safestart.processes.go_no_go.uncertainty import Member
from safestart.processes.wire import NO_SYNC_LIMIT, CorridorInput, Thrust, TumbleRate
from safestart.runtime.progress import Context

_SILENT = Context()


class GoNoGoQuery(Asked):
    """One operating point and one start, flat."""

    omega_t_deg_s: TumbleRate
    a_max_m_s2: Thrust
    x_m: float = Field(ge=-MAX_RANGE, le=MAX_RANGE, description="Body-frame x, m.", examples=[5.0])
    y_m: float = Field(
        ge=-MAX_RANGE, le=MAX_RANGE, description="Body-frame y, along the corridor, m.", examples=[40.0]
    )
    z_m: float | None = Field(
        None, ge=-MAX_RANGE, le=MAX_RANGE, description="Body-frame z, m; absent: the planar question."
    )
    rest: Rest = Field(Rest.LVLH, description="Frame in which the start is at rest.")
    mean_motion_rad_s: float = Field(
        1.1e-3, ge=0, le=MAX_MEAN_MOTION, description="Mean motion of the target's orbit, rad/s."
    )
    c_x: float = Field(1.5, gt=0, le=100, description="Corridor: slope of the +-x sides.")
    c_z: float = Field(1.5, gt=0, le=100, description="Corridor: slope of the +-z sides.")
    x0_m: float = Field(2.5, ge=0, le=1000, description="Corridor: half-width of the port in x, m.")
    z0_m: float = Field(2.5, ge=0, le=1000, description="Corridor: half-width of the port in z, m.")
    r_h_m: float = Field(0.5, ge=0, le=1000, description="Corridor: hold stand-off radius, m.")

    def inputs(self) -> GoNoGoInputs:
        """The same question as inputs of the go-no-go process; validated already, so not again."""
        corridor = CorridorInput.model_construct(
            c_x=self.c_x, c_z=self.c_z, x0_m=self.x0_m, z0_m=self.z0_m, r_h_m=self.r_h_m
        )
        return GoNoGoInputs.model_construct(
            omega_t_deg_s=self.omega_t_deg_s,
            a_max_m_s2=self.a_max_m_s2,
            mean_motion_rad_s=self.mean_motion_rad_s,
            corridor=corridor,
            states=[StateInput.model_construct(x_m=self.x_m, y_m=self.y_m, z_m=self.z_m)],
            rest=self.rest,
            **{name: getattr(self, name) for name in Asked.model_fields},
        )


class GoNoGoAnswer(WireModel):
    """The verdict on one start, with every margin it rests on."""

    verdict: Literal["GO", "NO_GO", "UNDECIDED"]
    margin_m: float | None = Field(
        description="Closed form: smallest margin, m; GO needs it positive. Exact: the proved bound."
    )
    face_margins_m: dict[str, float] = Field(description="Margin after erosion by face, m.")
    range_margin_m: float | None = Field(description="r_sync minus range, m; null without a limit.")
    r_sync_m: float | None = Field(description="Synchronization range limit, m; null when there is none.")
    r_sync_reason: str | None = Field(description="Why r_sync_m is null.")
    binding: str = Field(description="What gives the smallest margin: a face or 'range'.")
    violated_faces: list[str] = Field(
        description="Faces of the corridor that the start itself is outside of."
    )
    reason: str = Field(description="The verdict in a sentence.")
    proof: dict[str, Any] | None = Field(
        None, description="Proof document for `safestart verify`, when asked for."
    )
    proof_url: str | None = Field(
        None, description="Where the proof document is given alone; null for closed_form and UNDECIDED."
    )
    end_s: float | None = Field(
        None, description="When the flight of a GO is at rest in the hold ball (synchronize), s."
    )
    examples: list[Member] | None = Field(
        None,
        description="With half-widths, when UNDECIDED: members looked at, if possible one GO and one NO_GO.",
    )
    method: Method
    question: Kind
    rest: Rest


def flat_answer(query: GoNoGoQuery, context: Context = _SILENT) -> dict[str, Any]:
    """The go-no-go document of a single state, without arrays of length one."""
    if query.method != "closed_form":
        return single(run(query.inputs(), context).document)
    refuse_closed_form(query)
    shape = (query.c_x, query.c_z, query.x0_m, query.z0_m, query.r_h_m)
    z = query.z_m
    prepared = prepare(
        query.omega_t_deg_s, query.a_max_m_s2, query.mean_motion_rad_s, shape, query.rest, z is not None
    )
    point = certify_point(prepared, query.x_m, query.y_m, 0.0 if z is None else z)
    if point is None:
        return single(run(query.inputs(), _SILENT).document)
    binding, violated, reason = explain(
        prepared.faces, point.slack, point.face_margin, point.range_margin, point.margin
    )
    unlimited = prepared.limit == math.inf
    return {
        "verdict": "GO" if point.margin > 0.0 else "NO_GO",
        "margin_m": point.margin,
        "face_margins_m": dict(zip(prepared.faces, point.face_margin, strict=True)),
        "range_margin_m": None if unlimited else point.range_margin,
        "r_sync_m": None if unlimited else prepared.limit,
        "r_sync_reason": NO_SYNC_LIMIT if unlimited else None,
        "binding": binding,
        "violated_faces": violated,
        "reason": reason,
        "end_s": None,
        "examples": None,
        "proof": None,
        "method": "closed_form",
        "question": "stay",
        "rest": query.rest.value,
    }

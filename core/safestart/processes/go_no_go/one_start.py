"""One start: the flat question of a query string or a command line, and its answer without arrays."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from safestart.model.scenario import Rest
from safestart.processes.base import WireModel
from safestart.processes.flat import Flat
from safestart.processes.go_no_go.method_registry import MethodName
from safestart.processes.go_no_go.question_fields import QuestionKind
from safestart.processes.go_no_go.spec import DECIDED_BY, GoNoGoInputs, StateInput
from safestart.processes.go_no_go.uncertainty import Member
from safestart.processes.tracking_mpc.controller_input import TrackingAnswer
from safestart.processes.wire import CorridorInput

ONE_START = Flat(GoNoGoInputs, {"corridor": CorridorInput, "states": StateInput})


class GoNoGoAnswer(WireModel):
    """The verdict on one start, with every margin it rests on."""

    verdict: Literal["GO", "NO_GO", "UNDECIDED"]
    decided_by: str | None = Field(description=DECIDED_BY)
    margin_m: float | None = Field(
        description="certified, exact, atlas: the proved bound, m. paper: smallest margin, m; its GO needs it positive."
    )
    range_margin_m: float | None = Field(
        description="The paper's conditions (not sound): r_sync minus range, m; null without a limit."
    )
    binding: str = Field(
        description="The paper's conditions: what gives the smallest margin, a face or 'range'."
    )
    violated_faces: list[str] = Field(description="Faces of the corridor that the start itself violates.")
    reason: str = Field(description="The verdict in a sentence.")
    face_margins_m: dict[str, float] = Field(
        description="The paper's conditions (not sound): margin after erosion by face, m."
    )
    end_s: float | None = Field(
        None, description="When the flight of a GO is at rest in the hold ball (synchronize), s."
    )
    examples: list[Member] | None = Field(
        None,
        description="With half-widths, when UNDECIDED: members looked at, if possible one GO and one NO_GO.",
    )
    tracking: TrackingAnswer | None = Field(
        None, description="Method tracking: the controller's flight, beside the exact answer."
    )
    proof: dict[str, Any] | None = Field(
        None, description="Proof document for `safestart verify`, if requested."
    )
    proof_url: str | None = Field(
        None,
        description="Where a service gives the exact answer's proof document alone; null for paper and UNDECIDED.",
    )
    r_sync_m: float | None = Field(
        description="The paper's synchronization range limit, m; null when there is none."
    )
    r_sync_reason: str | None = Field(description="Why r_sync_m is null.")
    method: MethodName
    question: QuestionKind
    rest: Rest

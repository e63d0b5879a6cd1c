"""One start: the flat question of a query string or a command line, and its answer without arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from pydantic import Field

from safestart.model.scenario import Rest
from safestart.processes.base import WireModel
from safestart.processes.flat import Flat
from safestart.processes.go_no_go import run
from safestart.processes.go_no_go.method_registry import PROVING, MethodName, method_of
from safestart.processes.go_no_go.question_fields import QuestionKind
from safestart.processes.go_no_go.spec import (
    DECIDED_BY,
    HOLD_AFTER,
    SPEC,
    GoNoGoInputs,
    HoldAfter,
    StateInput,
)
from safestart.processes.go_no_go.uncertainty import Member
from safestart.processes.tracking_mpc.controller_input import TrackingAnswer
from safestart.processes.wire import CorridorInput
from safestart.runtime.progress import Context

ONE_START = Flat(GoNoGoInputs, {"corridor": CorridorInput, "states": StateInput})

_BY = {
    "certified": "the certificate in closed form (docs/theory/certified.md)",
    "exact": "a cone program",
    "atlas": "an atlas of cone programs",
    "families": "cone programs for all members",
    "tube": "a cone program in the tightened corridor",
    "paper": "the paper's conditions; this proves nothing",
}


class GoNoGoAnswer(WireModel):
    """The verdict on one start, with every margin it rests on."""

    verdict: Literal["GO", "NO_GO", "UNDECIDED"]
    decided_by: str | None = Field(description=DECIDED_BY)
    margin_m: float | None = Field(
        description="certified, exact, atlas: the proved bound, m; null when UNDECIDED. paper: smallest margin, m; its "
        "GO needs it positive."
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
    hold_after: HoldAfter | None = Field(None, description=HOLD_AFTER)


@dataclass(frozen=True, slots=True)
class OneAtRest:
    """The question about one start at rest; see ``OneStart`` of :mod:`safestart.processes.door`."""

    inputs: GoNoGoInputs

    def cost(self) -> float:
        """Seconds of one core, roughly."""
        return SPEC.cost(self.inputs)

    def at_once(self, context: Context) -> dict[str, Any] | None:
        """The document of a method that takes microseconds, else None."""
        found = run.at_once(self.inputs, context)
        return None if found is None else found.document_of_one()

    def document(self, context: Context) -> dict[str, Any]:
        """``GoNoGoAnswer``."""
        return run.answer(self.inputs, context).document_of_one()

    def sound(self) -> bool:
        """Whether every GO of the method can be flown."""
        return method_of(self.inputs.method).sound

    def with_proof(self) -> OneAtRest:
        """The same question with its proof, by the method asked for if that has one."""
        by = {} if method_of(self.inputs.method).proves else {"method": PROVING}
        return OneAtRest(self.inputs.model_copy(update={**by, "proofs": True}))

    def remarks(self, document: Mapping[str, Any]) -> list[str]:
        """Members looked at, what decided, and what the paper's conditions say of the start."""
        lines = [_told(member) for member in document["examples"] or ()]
        if document["decided_by"] is not None:
            lines.append(f"decided by: {_BY.get(document['decided_by'], document['decided_by'])}")
        r_sync = document["r_sync_m"]
        shown = f"{r_sync:.2f} m" if r_sync is not None else f"none ({document['r_sync_reason']})"
        margins = [
            f"margin after erosion {face:<11} {margin:9.2f} m"
            for face, margin in document["face_margins_m"].items()
        ]
        beside = "beside it the paper's conditions, which are not sound:"
        return [*lines, beside, f"synchronization range limit: {shown}", *margins]


def _told(member: Mapping[str, Any]) -> str:
    """One line for one member of the sets."""
    margin = member["margin_m"]
    return (
        f"{member['verdict']} for {member['omega_t_deg_s']:.6g} deg/s, {member['a_max_m_s2']:g} m/s^2, "
        f"{member['mean_motion_rad_s']:g} rad/s, start (LVLH) {member['position_m']} m, {member['velocity_m_s']} m/s: "
        f"margin {'-' if margin is None else format(margin, '.3g')} m"
    )

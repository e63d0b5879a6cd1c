"""One start in space: the flat question of a query string or a command line, and its answer without arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from pydantic import Field

from safestart.processes.base import WireModel
from safestart.processes.flat import Flat, Parameter
from safestart.processes.go_no_go.question_fields import QuestionKind
from safestart.processes.start_in_space.flight_output import SpaceFlight, Turning
from safestart.processes.start_in_space.parts import FiveFaces, SpaceStart
from safestart.processes.start_in_space.spec import (
    DECIDED_BY,
    SPEC,
    Method,
    SpaceInputs,
    SpaceOutputs,
)
from safestart.processes.tracking_mpc.controller_input import TrackingAnswer
from safestart.runtime.named import load
from safestart.runtime.progress import Context

_WHOLE = Flat(SpaceInputs, {"starts": SpaceStart})
_FIVE = Flat(SpaceInputs, {"starts": SpaceStart, "corridor": FiveFaces})
PARAMETERS: dict[str, Parameter] = _WHOLE.parameters | _FIVE.parameters
"""Flat names; the five faces come as their own parameters or, like any others, as the JSON of ``corridor``."""
_ARRAYS = (
    *("verdict", "decided_by", "margin_m", "model_error_m", "violated_faces", "position_m", "velocity_m_s"),
    *("reason", "end_s", "restriction", "flight", "tracking", "proof"),
)


class SpaceAnswer(WireModel):
    """The verdict on one start in space; fields as in the outputs of start-in-space."""

    verdict: Literal["GO", "NO_GO", "UNDECIDED"]
    decided_by: str | None = Field(description=DECIDED_BY)
    margin_m: float | None = Field(description=SpaceOutputs.model_fields["margin_m"].description)
    model_error_m: float = Field(description=SpaceOutputs.model_fields["model_error_m"].description)
    violated_faces: list[str] = Field(description=SpaceOutputs.model_fields["violated_faces"].description)
    reason: str = Field(description="The verdict in a sentence.")
    position_m: list[float] = Field(description="The start, LVLH, m.")
    velocity_m_s: list[float] = Field(description="The start, LVLH, m/s.")
    faces: list[str] = Field(description="Names of the faces.")
    end_s: float | None = Field(description="When the flight of a GO ends (synchronize), s.")
    restriction: list[str] | None = Field(
        None, description=SpaceOutputs.model_fields["restriction"].description
    )
    flight: SpaceFlight | None = Field(None, description="The flight of a GO (flights=true).")
    turning: Turning | None = Field(None, description=SpaceOutputs.model_fields["turning"].description)
    tracking: TrackingAnswer | None = Field(
        None, description="Method tracking: the controller's flight, beside the exact answer."
    )
    proof: dict[str, Any] | None = Field(
        None, description="Proof document for `safestart verify`, if requested."
    )
    proof_url: str | None = Field(
        None, description="Where a service gives the proof document alone; null for UNDECIDED."
    )
    method: Method
    question: QuestionKind


def parse(values: Mapping[str, Any]) -> SpaceInputs:
    """Validate flat values of JSON, strictly; raises ``InvalidInput`` under the flat name."""
    return _of(values).parse(values)


def read(texts: Mapping[str, str]) -> SpaceInputs:
    """As :func:`parse` for the texts of a query."""
    return _of(texts).read(texts)


def _of(given: Mapping[str, Any]) -> Flat[SpaceInputs]:
    return _WHOLE if "corridor" in given else _FIVE


@dataclass(frozen=True, slots=True)
class OneInSpace:
    """The question about one start in space; see ``OneStart`` of :mod:`safestart.processes.door`."""

    inputs: SpaceInputs

    def cost(self) -> float:
        """Seconds of one core, roughly."""
        return SPEC.cost(self.inputs)

    def at_once(self, context: Context) -> dict[str, Any] | None:  # noqa: ARG002
        """Nothing is known at once: every answer solves a program."""
        return None

    def document(self, context: Context) -> dict[str, Any]:
        """``SpaceAnswer`` for the only start."""
        found: dict[str, Any] = load(SPEC.run)(self.inputs, context).document
        return found | {name: found[name] and found[name][0] for name in _ARRAYS}

    def sound(self) -> bool:
        """True: no method says GO without a proof."""
        return True

    def with_proof(self) -> OneInSpace:
        """Ask for the proof, too."""
        return OneInSpace(self.inputs.model_copy(update={"proofs": True}))

    def remarks(self, document: Mapping[str, Any]) -> list[str]:  # noqa: ARG002
        """Say nothing more: the reason says it all."""
        return []

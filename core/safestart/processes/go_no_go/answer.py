"""The answer of go-no-go as documents: a method's verdicts on the starts beside the paper's conditions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from safestart.processes.go_no_go.conditions import Conditions
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.processes.wire import NO_SYNC_LIMIT, finite


class Verdicts(NamedTuple):
    """A method's results for S starts, each a list of S; None when the question has no such column.

    ``decided_by`` names what decided each start; without it the method itself decided all.
    """

    verdict: list[str]
    margin_m: Sequence[float | None]
    reason: list[str]
    end_s: list[float | None] | None = None
    examples: list[list[dict[str, Any]]] | None = None
    proof: list[dict[str, Any] | None] | None = None
    decided_by: list[str | None] | None = None
    tracking: list[dict[str, Any]] | None = None
    hold_after: list[dict[str, Any] | None] | None = None


class Answer(NamedTuple):
    """Question, conditions and verdicts; only this class writes the two documents."""

    inputs: GoNoGoInputs
    conditions: Conditions
    verdicts: Verdicts

    def document(self) -> dict[str, Any]:
        """``GoNoGoOutputs``: arrays over the starts."""
        return {
            name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in self.parts()
        }

    def parts(self) -> Iterator[tuple[str, Any]]:
        """The members of the document; one of them may be an array, which takes a fifth of the memory of lists."""
        inputs, found, said = self
        limit = finite(found.limit)
        yield from {
            "method": inputs.method,
            "question": inputs.question,
            "rest": inputs.rest.value,
            "r_sync_m": limit,
            "r_sync_reason": NO_SYNC_LIMIT if limit is None else None,
            "faces": list(found.faces),
            "verdict": said.verdict,
            "decided_by": self.decided_by(),
            "margin_m": said.margin_m,
            "face_margins_m": found.face_margin,
            "range_margin_m": [finite(value) for value in found.range_margin],
            "binding": found.binding,
            "violated_faces": found.violated,
            "reason": said.reason,
            "end_s": said.end_s,
            "examples": said.examples,
            "tracking": said.tracking,
            "proof": said.proof,
            **({} if said.hold_after is None else {"hold_after": said.hold_after}),
        }.items()

    def document_of_one(self) -> dict[str, Any]:
        """``GoNoGoAnswer``: the only start, flat, its face margins by name."""
        inputs, found, said = self
        limit = finite(found.limit)
        return {
            "verdict": said.verdict[0],
            "decided_by": self.decided_by()[0],
            "margin_m": said.margin_m[0],
            "range_margin_m": finite(found.range_margin[0]),
            "binding": found.binding[0],
            "violated_faces": found.violated[0],
            "reason": said.reason[0],
            "face_margins_m": dict(zip(found.faces, found.face_margin[0], strict=True)),
            "end_s": said.end_s and said.end_s[0],
            "examples": said.examples and said.examples[0],
            "tracking": said.tracking and said.tracking[0],
            "proof": said.proof and said.proof[0],
            "r_sync_m": limit,
            "r_sync_reason": NO_SYNC_LIMIT if limit is None else None,
            "method": inputs.method,
            "question": inputs.question,
            "rest": inputs.rest.value,
            **({} if said.hold_after is None else {"hold_after": said.hold_after[0]}),
        }

    def decided_by(self) -> list[str | None]:
        """What decided each start, None for those that nothing decided."""
        said = self.verdicts
        if said.decided_by is not None:
            return said.decided_by
        return [None if word == "UNDECIDED" else self.inputs.method for word in said.verdict]

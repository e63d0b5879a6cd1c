"""The return value of a process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from safestart.records.artifact import Artifact


@dataclass(frozen=True, slots=True)
class Undrawn:
    """A picture that could not be drawn: its file name, and why. The result says so in a note."""

    name: str
    reason: str


@dataclass(frozen=True, slots=True)
class ProcessOutput:
    """A JSON-able document, and its artifacts beside the pictures that could not be drawn."""

    document: dict[str, Any]
    made: tuple[Artifact | Undrawn, ...] = ()

    @property
    def artifacts(self) -> tuple[Artifact, ...]:
        """The files of the result."""
        return tuple(item for item in self.made if isinstance(item, Artifact))

    @property
    def notes(self) -> list[str]:
        """What is missing in the result, in sentences."""
        return [
            f"{item.name} could not be drawn ({item.reason})."
            for item in self.made
            if isinstance(item, Undrawn)
        ]

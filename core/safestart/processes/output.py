"""The return value of a process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from safestart.records.artifact import Artifact


@dataclass(frozen=True, slots=True)
class ProcessOutput:
    """A JSON-able document and its artifacts."""

    document: dict[str, Any]
    artifacts: tuple[Artifact, ...] = ()

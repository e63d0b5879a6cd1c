"""Execute a process by id; service, worker, CLI and notebook share this path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from safestart.errors import UnfitResult
from safestart.processes.base import Artifact, ProcessOutput, ProcessSpec, WireModel
from safestart.processes.registry import process
from safestart.processes.sharding import Part
from safestart.records.provenance import versions
from safestart.runtime.progress import Context

SCHEMA_VERSION = 1


@dataclass(frozen=True, slots=True)
class Execution:
    """A finished run: the document ``{schema_version, process, inputs, outputs, provenance}`` and its artifacts."""

    document: dict[str, Any]
    artifacts: tuple[Artifact, ...]


def execute(process_id: str, inputs: Any, context: Context | None = None) -> Execution:
    """Validate the inputs, run the process, check the outputs, add the provenance.

    Inputs that come from a store are validated already: give what ``ProcessSpec.stored`` makes of them. Raises
    ``NotFound`` for an unknown process, ``InvalidInput`` for inputs outside the spec, and ``UnfitResult`` for outputs
    outside it.
    """
    spec = process(process_id)
    parsed = spec.parse(inputs)
    spec.require_possible(parsed)
    started = datetime.now(UTC)
    return _finished(spec, parsed, started, spec.runner()(parsed, context or Context()))


def merge(
    process_id: str, inputs: Any, parts: Sequence[Part], started: datetime, context: Context | None = None
) -> Execution:
    """Merge a sharded process whose shards ran elsewhere since ``started``; raises as :func:`execute`.

    The inputs were validated before its shards ran.
    """
    spec = process(process_id)
    parsed = spec.stored(inputs)
    if spec.sharding is None:
        raise ValueError(f"process {process_id} has no shards")
    return _finished(spec, parsed, started, spec.sharding.merged(parsed, parts, context or Context()))


def _finished(spec: ProcessSpec, parsed: WireModel, started: datetime, output: ProcessOutput) -> Execution:
    if not isinstance(output, ProcessOutput):
        raise UnfitResult(
            f"process {spec.id}: required a ProcessOutput from its function, received {type(output).__name__}",
            required="a ProcessOutput",
            received=type(output).__name__,
        )
    spec.check(output.document)
    dumped = parsed.model_dump(mode="json")
    document = {
        "schema_version": SCHEMA_VERSION,
        "process": {"id": spec.id, "version": spec.version},
        "inputs": dumped,
        "outputs": output.document,
        "provenance": {
            "seed": dumped.get("seed"),
            "started": started.isoformat(),
            "finished": datetime.now(UTC).isoformat(),
            "artifacts": {artifact.name: artifact.sha256 for artifact in output.artifacts},
            **({"notes": output.notes} if output.notes else {}),
            **versions(),
        },
    }
    return Execution(document, output.artifacts)

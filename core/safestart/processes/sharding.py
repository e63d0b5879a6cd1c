"""A process cut into shards: pure parts that run anywhere in any order and are merged by index.

The parts depend only on the inputs, not on the number of workers, so the result is the same for one worker or many, and
after a worker was killed. The runner may store each shard's result and skip it when the job resumes.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from hashlib import sha256
from typing import Any

from safestart.campaign.part import Part as Part
from safestart.model.wire_model import WireModel
from safestart.processes.output import ProcessOutput
from safestart.records.comparable import canonical
from safestart.runtime.named import load
from safestart.runtime.progress import Context

MAX_SHARDS = 10_000


@dataclass(frozen=True, slots=True)
class Sharding:
    """Four pure functions, each named as ``module:function``.

    ``split`` (inputs) -> parts, JSON-able dictionaries; light to import. ``shard`` (part, context) -> :class:`Part`.
    ``merge`` (inputs, parts in order, context) -> ``ProcessOutput``. ``summary`` (inputs, documents of the finished
    shards) -> document of the partial result; light to import, as the service answers with it.
    """

    split: str
    shard: str
    merge: str
    summary: str

    @classmethod
    def of(cls, package: str, light: str = "study") -> Sharding:
        """Where a process usually has them: ``split`` and ``summary`` in its ``light`` module, the others in run."""
        return cls(
            split=f"{package}.{light}:split",
            shard=f"{package}.run:shard",
            merge=f"{package}.run:merge",
            summary=f"{package}.{light}:summary",
        )

    def parts(self, inputs: WireModel) -> list[dict[str, Any]]:
        """The parts of a job, 1 to ``MAX_SHARDS``."""
        parts: list[dict[str, Any]] = load(self.split, "split of a process")(inputs)
        if not 1 <= len(parts) <= MAX_SHARDS:
            raise ValueError(f"split: required 1 to {MAX_SHARDS} parts, received {len(parts)}")
        return parts

    def run_part(self, part: dict[str, Any], context: Context) -> Part:
        """Run one shard."""
        done: Part = load(self.shard, "shard of a process")(part, context)
        return done

    def merged(self, inputs: WireModel, parts: Sequence[Part], context: Context) -> ProcessOutput:
        """The result of a job from all its parts."""
        output: ProcessOutput = load(self.merge, "merge of a process")(inputs, parts, context)
        return output

    def so_far(self, inputs: WireModel, documents: Iterable[dict[str, Any]]) -> dict[str, Any]:
        """The partial result from the finished shards."""
        document: dict[str, Any] = load(self.summary, "summary of a process")(inputs, documents)
        return document

    def run(self, inputs: WireModel, context: Context) -> ProcessOutput:
        """Run every shard here, one after the other, then merge."""
        parts = self.parts(inputs)
        count = len(parts)
        done = []
        for index, part in enumerate(parts):
            label = f"shard {index + 1} of {count}"
            context.step(index, count + 1, label)
            done.append(self.run_part(part, context.part(index, 1.0, count + 1, label)))
        context.step(count, count + 1, "merging")
        return self.merged(inputs, done, context.part(count, 1.0, count + 1, "merging"))


def content(process_id: str, part: dict[str, Any], by: str) -> str:
    """SHA-256 of all that a shard's result depends on: process, part, and the source ``by`` which it is computed."""
    text = canonical([process_id, part, by])
    return sha256(text.encode()).hexdigest()
